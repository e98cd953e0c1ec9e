// flirt/io/ros_log.hpp: a log of scans from the messages of a ROS recording.
//
// Scans are the sensor_msgs/LaserScan of one topic: that of ReadOptions::message, else the first that appears; other
// topics are counted. Stamps are those of the messages' headers, the order is that of the file.
//
// Where things are, by the frames (tf) above the scanner's, as REP 105 names them ("map", "odom", perhaps behind a
// robot's name and "/"):
//  - the robot is the frame right below odom; without odom that below map; else the child frame of nav_msgs/Odometry;
//    else the topmost frame;
//  - odometry is the robot in odom, else the first nav_msgs/Odometry topic; at the stamp of a scan, interpolated; a
//  scan
//    more than a second before its beginning or after its end has none;
//  - the poses of the log are the robot in map, where there is one (before its first and after its last pose of odom,
//    that one), else the odometry if all scans have it.
// Poses are those of the plane. A scanner mounted upside down has its beams reversed, so that frames see it from above.
#pragma once

#include "flirt/core/parallel.hpp"
#include "flirt/core/result.hpp"
#include "flirt/io/log.hpp"

#include <filesystem>

namespace flirt {

/// Reads a recording (see flirt/io/recording.hpp). In the report `lines` are messages, and their kinds topics. Errors:
/// those of the file; broken messages (unless lenient, when also a file that is cut short counts as one); no such
/// topic; a scanner that is tilted by more than 15°.
[[nodiscard]] Result<LoadedLog> read_ros_log(const std::filesystem::path& path, const ReadOptions& options = {},
                                             const Progress& progress = {});

}  // namespace flirt
