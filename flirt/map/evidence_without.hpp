// flirt/map/evidence_without.hpp: a map's evidence as if some of its scans had never been there.
#pragma once

#include "flirt/core/scan_interval.hpp"
#include "flirt/grid/evidence_grid.hpp"
#include "flirt/map/place_map.hpp"
#include "flirt/registration/map_fields.hpp"

#include <optional>

namespace flirt {

/// Fields of a map for localization, whole or without an interval of its scans (the protocols of eval/localization.hpp
/// take the neighbours of a query out of the map). Not shared between threads.
class EvidenceWithout {
 public:
  EvidenceWithout(const PlaceMap& map, const MapFieldParams& params) : map_(map), params_(params) {}

  /// Fields without the evidence of the scans in `excluded`, exactly as a map built without them would have them.
  /// When `excluded` is another than in the last call, the tiles whose evidence differs are made anew.
  const MapFields& fields(ScanInterval excluded);

 private:
  void take_out(ScanInterval excluded);

  PlaceMap map_;
  MapFieldParams params_;
  std::optional<EvidenceGrid> thinned_{};  ///< evidence without the scans of `excluded_`, once any were taken out
  ScanInterval excluded_{};
  std::optional<MapFields> fields_{};
};

}  // namespace flirt
