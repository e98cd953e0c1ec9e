#include "apps/flirt/localize_flags.hpp"

#include <vector>

namespace flirt::app {

void LocalizeFlags::add(CLI::App& command, ParamFlags& params) {
  std::vector<std::string> names;
  for (const auto& [value, name] : enum_names(LocalizeMethod{})) { names.emplace_back(name); }
  command
      .add_option("--method", method_,
                  "where candidate poses come from: dense search, votes of features, auto, or the papers' matching of "
                  "single scans (default auto)")
      ->check(CLI::IsMember(names));
  params.add(command, "localize", params_, {}, FlagNames::plain);
  params.add(command, "fields", params_.fields);
  params.add(command, "search", params_.search);
  params.add(command, "landmarks", params_.landmarks);
  params.add(command, "verdict", params_.verdict);
  params.add(command, "papers", params_.papers);
  params.add(command, "match", params_.papers.match);
  params.add(command, "ransac", params_.papers.ransac);
}

LocalizeParams LocalizeFlags::localize() const {
  LocalizeParams params = params_;
  for (const auto& [value, name] : enum_names(LocalizeMethod{})) {
    if (name == method_) { params.method = value; }
  }
  return params;
}

}  // namespace flirt::app
