// flirt/map/place_map.hpp: scans with their poses and features: the map m = {(z, F)_0..n} in which a robot finds itself
// (navigation paper, section 3.2).
//
//   const Result<PlaceMap> map = build_place_map(log);                // in memory
//   const auto map = read_place_map("office.flirt");                  // flirt/io/flirt_map.hpp: opened in place
//   const LocalizationResult found = localize(*map, scan);            // flirt/map/localize.hpp
#pragma once

#include "flirt/core/aligned_vector.hpp"
#include "flirt/core/parallel.hpp"
#include "flirt/core/result.hpp"
#include "flirt/core/scan.hpp"
#include "flirt/core/scan_interval.hpp"
#include "flirt/features/extract.hpp"
#include "flirt/grid/evidence_grid.hpp"
#include "flirt/match/columns.hpp"
#include "flirt/match/distance.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace flirt {

/// What a place map consists of: n scans with r readings and k features in all, over g different beam geometries.
/// `Column` is a vector (a map being built) or a view (of such vectors, or of a file).
template <template <class> class Column>
struct PlaceMapColumns {
  Column<Pose2> map_from_sensor{};        ///< n; where each scan was taken
  Column<Pose2> robot_from_sensor{};      ///< n
  Column<std::uint32_t> geometry{};       ///< n, index into `beams`
  Column<Beams> beams{};                  ///< g, each geometry once
  Column<std::uint64_t> range_begin{};    ///< n + 1; scan i has readings range_begin[i] .. range_begin[i + 1]
  Column<float> ranges{};                 ///< r, m, as the sensor gave them (`classify` before use)
  Column<std::uint64_t> feature_begin{};  ///< n + 1; scan i has features feature_begin[i] .. feature_begin[i + 1]
  Column<float> x{};                      ///< k, m, keypoint in the frame of its sensor
  Column<float> y{};                      ///< k, m
  Column<float> theta{};                  ///< k, rad, the keypoint's own direction
  Column<float> scale{};                  ///< k, as Keypoint::scale
  Column<float> support_radius{};         ///< k, m
  Column<float> response{};               ///< k
  Column<std::uint32_t> beam{};           ///< k, index into the readings of its scan
  Column<std::uint8_t> level{};           ///< k
  Column<float> descriptor_rows{};        ///< k · stride, as Descriptors::rows
  Column<float> descriptor_roots{};       ///< k · stride, as Descriptors::roots
  Column<float> descriptor_variances{};   ///< k · stride, as Descriptors::variances; empty in a map without them
};
template <class T>
using MapVector = AlignedVector<T>;
template <class T>
using MapView = std::span<const T>;
using PlaceMapVectors = PlaceMapColumns<MapVector>;
using PlaceMapViews = PlaceMapColumns<MapView>;

[[nodiscard]] PlaceMapViews views_of(const PlaceMapVectors& vectors);

/// visit(name, column) for each column; the names are those of the sections of a map file.
template <class Columns, class Visitor>
void visit_columns(Columns& columns, Visitor&& visit) {
  visit(std::string_view("map_from_sensor"), columns.map_from_sensor);
  visit(std::string_view("robot_from_sensor"), columns.robot_from_sensor);
  visit(std::string_view("geometry"), columns.geometry);
  visit(std::string_view("beams"), columns.beams);
  visit(std::string_view("range_begin"), columns.range_begin);
  visit(std::string_view("ranges"), columns.ranges);
  visit(std::string_view("feature_begin"), columns.feature_begin);
  visit(std::string_view("x"), columns.x);
  visit(std::string_view("y"), columns.y);
  visit(std::string_view("theta"), columns.theta);
  visit(std::string_view("scale"), columns.scale);
  visit(std::string_view("support_radius"), columns.support_radius);
  visit(std::string_view("response"), columns.response);
  visit(std::string_view("beam"), columns.beam);
  visit(std::string_view("level"), columns.level);
  visit(std::string_view("descriptor_rows"), columns.descriptor_rows);
  visit(std::string_view("descriptor_roots"), columns.descriptor_roots);
  visit(std::string_view("descriptor_variances"), columns.descriptor_variances);
}

/// Whether a map keeps the variances of its descriptors. Only the distance variance_chi_square looks at them, and they
/// are half as much again as the rest of the descriptors.
enum class MapVariances : std::uint8_t { leave_out, keep };

/// What a map must keep for its descriptors to be compared by `distance`.
[[nodiscard]] constexpr MapVariances variances_for(Distance distance) {
  return distance == Distance::variance_chi_square ? MapVariances::keep : MapVariances::leave_out;
}

/// Scans with poses and features, and the evidence that all their beams leave, read-only. Copies share all of it, so
/// they are cheap; the columns may lie in a file that is mapped into memory. Invariant: the columns fit together
/// (sizes, ascending begins, indices in range, finite poses).
class PlaceMap {
 public:
  /// `columns` must stay as they are while `owner` lives. An error says which column does not fit. O(n + k).
  [[nodiscard]] static Result<PlaceMap> from_columns(const PlaceMapViews& columns, std::uint32_t descriptor_dimension,
                                                     std::uint32_t descriptor_stride, const FeatureParams& params,
                                                     EvidenceGrid evidence, std::shared_ptr<const void> owner);

  [[nodiscard]] std::size_t size() const { return columns_.map_from_sensor.size(); }
  [[nodiscard]] std::size_t feature_count() const { return columns_.x.size(); }
  [[nodiscard]] const PlaceMapViews& columns() const { return columns_; }
  [[nodiscard]] std::uint32_t descriptor_dimension() const { return descriptor_dimension_; }
  [[nodiscard]] std::uint32_t descriptor_stride() const { return descriptor_stride_; }
  /// How the features were made; a query has to be described the same way.
  [[nodiscard]] const FeatureParams& feature_params() const { return params_; }
  [[nodiscard]] bool has_variances() const { return !columns_.descriptor_variances.empty(); }
  /// Hits and passes of all beams of all scans, by their ranges as stored here (floats), or of a grid map.
  [[nodiscard]] const EvidenceGrid& evidence() const { return *evidence_; }
  /// Bytes of all columns and of the evidence.
  [[nodiscard]] std::size_t bytes() const;

  [[nodiscard]] const Pose2& map_from_sensor(std::size_t scan) const { return columns_.map_from_sensor[scan]; }
  [[nodiscard]] Pose2 map_from_robot(std::size_t scan) const;
  /// Geometry of a scan's beams.
  [[nodiscard]] const Beams& beams(std::size_t scan) const { return columns_.beams[columns_.geometry[scan]]; }
  /// Readings of a scan, m.
  [[nodiscard]] std::span<const float> ranges(std::size_t scan) const;
  /// Copy of a scan; stamp and odometry are not kept in a map, and ranges are rounded to floats of the same meaning.
  [[nodiscard]] Scan scan(std::size_t scan) const;
  /// The features of a scan, in place.
  [[nodiscard]] FeatureColumns features(std::size_t scan) const;

 private:
  friend class PlaceMapBuilder;
  PlaceMap() = default;
  PlaceMapViews columns_{};
  std::uint32_t descriptor_dimension_{0};
  std::uint32_t descriptor_stride_{0};
  FeatureParams params_{};
  std::shared_ptr<const EvidenceGrid> evidence_{};
  std::shared_ptr<const void> owner_{};
};

/// The map scan taken nearest to a pose, 0.5 m counting as much as 45°; of equal ones the first. Scans in `excluded`
/// are left out. Nothing for a map without scans. O(n).
[[nodiscard]] std::optional<std::size_t> nearest_scan(const PlaceMap& map, const Pose2& map_from_sensor,
                                                      ScanInterval excluded = {});

/// Puts a place map together scan by scan.
class PlaceMapBuilder {
 public:
  explicit PlaceMapBuilder(const FeatureParams& params = {}, MapVariances variances = MapVariances::leave_out)
      : params_(params), variances_(variances) {}

  /// `map_from_sensor` must be finite and within 10⁷ m; all descriptors of a map have the same dimension.
  void add(const Scan& scan, const Pose2& map_from_sensor, const Features& features);

  /// The map of all scans added, with the evidence of their beams; the builder is used up.
  [[nodiscard]] PlaceMap build() &&;
  /// The same with evidence from elsewhere: for maps whose scans were made up from a grid map.
  [[nodiscard]] PlaceMap build(EvidenceGrid evidence) &&;

 private:
  void add_geometry(const Beams& beams);
  void add_features(const Features& features);

  std::map<std::array<std::uint64_t, 4>, std::uint32_t>
      geometries_{};  ///< by their bits: index into the column of beams
  PlaceMapVectors columns_{.range_begin = {0}, .feature_begin = {0}};
  std::uint32_t descriptor_dimension_{0};
  std::uint32_t descriptor_stride_{0};
  FeatureParams params_;
  MapVariances variances_;
};

/// The map of all scans of a log. Map scan i is log scan i. Error: a scan has no pose, or one that is not finite.
/// Parallel; the same on any number of threads.
[[nodiscard]] Result<PlaceMap> build_place_map(const ScanLog& log, const FeatureParams& params = {},
                                               std::size_t threads = 0, const Progress& progress = {},
                                               MapVariances variances = MapVariances::leave_out);

}  // namespace flirt
