#include "flirt/slam/front_ends.hpp"

namespace flirt {

FrontEnd make_front_end(const SlamParams& params) {
  switch (params.front_end) {
    case FrontEndKind::flirt:
      return FlirtFrontEnd(params);
    case FrontEndKind::olson:
    case FrontEndKind::icp:
      return PairFrontEnd(params);
    case FrontEndKind::automatic:
    case FrontEndKind::scan:
      break;
  }
  return ScanFrontEnd(params);
}

LoopFinder make_loop_finder(const SlamParams& params) {
  if (params.front_end == FrontEndKind::flirt) { return FlirtConstraints(params); }
  SlamParams used = params;
  // Scan against scans, as they are.
  if (params.front_end == FrontEndKind::olson || params.front_end == FrontEndKind::icp) { used.loop_query_scans = 1; }
  return LoopCloser(used);
}

}  // namespace flirt
