# flirt_options: language level and warnings of every target of this project.
add_library(flirt_options INTERFACE)
target_compile_features(flirt_options INTERFACE cxx_std_20)
target_compile_options(flirt_options INTERFACE -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror)
target_compile_options(flirt_options INTERFACE $<$<AND:$<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>,$<CXX_COMPILER_ID:GNU>>:-Wno-subobject-linkage>)
# GCC 12 sees overlaps in `"text" + string` that aren't there (its bug 105651).
target_compile_options(flirt_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
# The standard library's own std::stable_sort uses what it calls deprecated.
target_compile_options(flirt_options INTERFACE $<$<CXX_COMPILER_ID:Clang>:-Wno-deprecated-declarations>)
# No multiply-add unless it is asked for: the same bits on processors with and without the instruction.
target_compile_options(flirt_options INTERFACE -ffp-contract=off)

# flirt_module(NAME [USES modules...] [LINK libraries...]): the library flirt_NAME from flirt/NAME/*.cpp.
function(flirt_module name)
  cmake_parse_arguments(ARG "" "" "USES;LINK" ${ARGN})
  list(TRANSFORM ARG_USES PREPEND flirt_)
  file(GLOB sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/flirt/${name}/*.cpp")
  if(sources)
    add_library(flirt_${name} STATIC ${sources})
    foreach(source ${sources})  # Highway compiles such a file once for each kind of processor
      file(STRINGS "${source}" per_target REGEX "hwy/foreach_target.h" LIMIT_COUNT 1)
      if(per_target)
        set_source_files_properties("${source}" PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
      endif()
    endforeach()
    set(scope PUBLIC)
    target_link_libraries(flirt_${name} PRIVATE $<BUILD_INTERFACE:flirt_options>)
  else()
    add_library(flirt_${name} INTERFACE)
    set(scope INTERFACE)
  endif()
  target_compile_features(flirt_${name} ${scope} cxx_std_20)
  target_include_directories(flirt_${name} ${scope} $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:include>)
  target_link_libraries(flirt_${name} ${scope} ${ARG_USES} ${ARG_LINK})
  set_target_properties(flirt_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  install(TARGETS flirt_${name} EXPORT flirtTargets)
endfunction()

# flirt_install(): headers and the package that find_package(flirt) reads.
function(flirt_install)
  include(GNUInstallDirs)
  include(CMakePackageConfigHelpers)
  install(TARGETS flirt EXPORT flirtTargets)
  install(EXPORT flirtTargets NAMESPACE flirt:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/flirt)
  install(DIRECTORY "${PROJECT_SOURCE_DIR}/flirt" DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.hpp")
  write_basic_package_version_file("${PROJECT_BINARY_DIR}/flirtConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
  install(FILES "${PROJECT_SOURCE_DIR}/cmake/flirtConfig.cmake" "${PROJECT_BINARY_DIR}/flirtConfigVersion.cmake"
          DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/flirt)
endfunction()
