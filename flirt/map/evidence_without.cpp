#include "flirt/map/evidence_without.hpp"

#include <algorithm>

namespace flirt {

const MapFields& EvidenceWithout::fields(ScanInterval excluded) {
  if (fields_ && excluded == excluded_) { return *fields_; }
  if (excluded == ScanInterval{}) {
    thinned_.reset();
    excluded_ = excluded;
  } else {
    take_out(excluded);
  }
  const EvidenceGrid& evidence = thinned_ ? *thinned_ : map_.evidence();
  fields_ = fields_ ? updated_fields(*fields_, evidence) : map_fields(evidence, params_);
  return *fields_;
}

void EvidenceWithout::take_out(ScanInterval excluded) {
  if (!thinned_) { thinned_ = map_.evidence(); }
  for (std::size_t scan = excluded_.begin; scan < excluded_.end; ++scan) {
    if (!excluded.contains(scan)) { thinned_->add(map_.scan(scan), map_.map_from_sensor(scan)); }
  }
  for (std::size_t scan = excluded.begin; scan < excluded.end; ++scan) {
    if (!excluded_.contains(scan)) { thinned_->remove(map_.scan(scan), map_.map_from_sensor(scan)); }
  }
  excluded_ = excluded;
}

}  // namespace flirt
