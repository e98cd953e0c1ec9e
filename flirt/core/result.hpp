// flirt/core/result.hpp: how a call that depends on the outside world says that it failed.
#pragma once

#include <tl/expected.hpp>

#include <string>

namespace flirt {

/// What was expected, what was found, and where: "fr079.log:12: expected 360 ranges, found 17".
struct Error {
  std::string message;
};

template <class T>
using Result = tl::expected<T, Error>;

[[nodiscard]] inline tl::unexpected<Error> fail(std::string message) {
  return tl::unexpected<Error>(Error{std::move(message)});
}

}  // namespace flirt
