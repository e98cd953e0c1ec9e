// flirt/io/carmen.hpp: CARMEN logs, the text format of most published 2D laser data.
//
// Scan lines: FLASER, RLASER (no angles; two poses), ROBOTLASER1, 2, … (angles; pose of laser and of robot) and
// RAWLASER1, 2, … (angles, no pose: that of the ODOM line with the same stamp, else of the last before). A log may hold
// the same sweeps as several kinds: one kind is read, the others are counted.
//
// Angles of FLASER and RLASER, which the format leaves out. From −90°, counter-clockwise: 180 beams in steps of 1°,
// 181 the same including +90°, 360 and 361 in steps of 0.5°; in general 180° / n for even n and 180° / (n − 1) for odd.
// Known scanners of other fields of view: 401 beams ±50°, 541 and 1081 beams ±135°, 682 beams of 360°/1024 about 0°.
//
// Poses. The first pose of a FLASER line is the laser's, the second the robot's. That is what CARMEN wrote, and the
// real logs agree: the walls of the corrected fr079 and fr101 logs, whose laser sits at −0.04 m, are sharpest when the
// first pose is taken for the laser's. Whether a log is corrected is told from its other lines: VERTEX2 (graph SLAM) or
// NEFF (particle filter SLAM) say that the poses of the scan lines are; TRUEPOS holds true poses of the scans that
// follow. Otherwise
//  - ROBOTLASER and RAWLASER have odometry;
//  - FLASER with two equal poses throughout: odometry, logged twice;
//  - FLASER with its poses one constant motion apart: odometry, and the motion is where the laser sits;
//  - other FLASER: the first pose is corrected, the second is odometry.
// In a corrected log whose two poses are equal, or one constant motion apart, the second is no odometry and is left
// out.
//
// The laser on the robot: ROBOTLASER says where; for the others PARAM robot_frontlaser_offset (robot_rearlaser_offset
// for RLASER, which looks backwards) does, else it sits at the robot's origin.
//
// The longest valid range, unless the caller gives it: what the scan line declares, else PARAM robot_front_laser_max,
// else 50 m. When that leaves a pile of equal readings as the largest of the log, that value is "no return" (32.77 and
// 8.191 are common): at least 10 readings and 0.1 % of all, and 10 times as many as at any of the next 100 values.
#pragma once

#include "flirt/core/parallel.hpp"
#include "flirt/core/result.hpp"
#include "flirt/core/scan.hpp"
#include "flirt/io/file.hpp"
#include "flirt/io/log.hpp"

#include <filesystem>
#include <string>
#include <string_view>

namespace flirt {

/// True when the line is of a kind that CARMEN logs hold (comments and blank lines do not count).
[[nodiscard]] bool is_carmen_line(std::string_view line);

/// Reads all lines from the first on. Errors: broken lines (unless lenient), no scan line of the wanted kind.
[[nodiscard]] Result<LoadedLog> read_carmen(LineReader& lines, const ReadOptions& options = {},
                                            const Progress& progress = {});

/// The log as CARMEN text: per scan an ODOM line with the odometry, and a ROBOTLASER1 line with the odometry, else with
/// the log's pose. Poses of the log are kept as TRUEPOS beside odometry that differs, as VERTEX2 without odometry.
/// Odometry that only some scans have is left out: the format has no place for it. Logs with neither are written as
/// RAWLASER1. Numbers are written so that they read back the same;
/// Beams::range_min has no place in the format. Error: RAWLASER1 cannot tell where the laser sits beyond an offset
/// ahead.
[[nodiscard]] Result<std::string> to_carmen(const ScanLog& log);

/// to_carmen into a file, at once or not at all.
[[nodiscard]] Result<void> write_carmen(const std::filesystem::path& path, const ScanLog& log);

}  // namespace flirt
