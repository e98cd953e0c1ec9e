#include "flirt/io/feature_params_json.hpp"

#include "flirt/io/params_json.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace flirt {
namespace {

template <class Choice>
nlohmann::ordered_json json_from_choice(std::string_view name, const Choice& choice) {
  return {{"name", name}, {"params", std::visit([](const auto& params) { return json_from_params(params); }, choice)}};
}

/// The alternative that `json` names, found by `from_name`, with its parameters.
template <class FromName>
auto choice_from_json(const nlohmann::ordered_json& json, const std::string& key, const FromName& from_name)
    -> Result<typename decltype(from_name({}))::value_type> {
  const auto found = json.find(key);
  if (found == json.end() || !found->contains("name") || !found->contains("params") || !(*found)["name"].is_string()) {
    return fail("expected the name and the params of the " + key + ", found none");
  }
  auto choice = from_name((*found)["name"].template get_ref<const std::string&>());
  if (!choice) { return fail("expected a " + key + " of this version, found " + (*found)["name"].dump()); }
  const std::string complaint =
      std::visit([&found](auto& params) { return params_from_json((*found)["params"], params); }, *choice);
  if (!complaint.empty()) { return fail(key + ": " + complaint); }
  return *choice;
}

}  // namespace

nlohmann::ordered_json json_from_feature_params(const FeatureParams& params) {
  return {{"detector", json_from_choice(detector_name(params.detector), params.detector)},
          {"descriptor", json_from_choice(descriptor_name(params.descriptor), params.descriptor)}};
}

Result<FeatureParams> feature_params_from_json(const nlohmann::ordered_json& json) {
  const Result<DetectorParams> detector = choice_from_json(json, "detector", detector_from_name);
  if (!detector) { return tl::unexpected(detector.error()); }
  const std::string complaint = std::visit([](const auto& params) { return too_coarse(params.scales); }, *detector);
  if (!complaint.empty()) { return fail("detector: " + complaint); }
  const Result<DescriptorParams> descriptor = choice_from_json(json, "descriptor", descriptor_from_name);
  if (!descriptor) { return tl::unexpected(descriptor.error()); }
  return FeatureParams{.detector = *detector, .descriptor = *descriptor};
}

}  // namespace flirt
