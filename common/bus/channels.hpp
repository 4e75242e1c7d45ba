// SPDX-License-Identifier: BSD-3-Clause
/// @file Channel names. docs/architecture.md says who speaks and who listens; a test compares.
#pragma once

namespace modslam::channel {

inline constexpr const char* kLaser = "LASER";
inline constexpr const char* kSensorInfo = "SENSOR_INFO";
inline constexpr const char* kOdometry = "ODOMETRY";
inline constexpr const char* kIns = "INS";
inline constexpr const char* kGroundTruth = "GROUND_TRUTH";
inline constexpr const char* kScanMatch = "SCAN_MATCH";
inline constexpr const char* kPose = "POSE";
inline constexpr const char* kNode = "NODE";
inline constexpr const char* kGraph = "GRAPH";
inline constexpr const char* kLoop = "LOOP";
inline constexpr const char* kLoopSearch = "LOOP_SEARCH";
inline constexpr const char* kSyncRequest = "SYNC_REQUEST";
inline constexpr const char* kRepeatRequest = "REPEAT_REQUEST";
inline constexpr const char* kRepeat = "REPEAT";
inline constexpr const char* kMapTile = "MAP_TILE";
inline constexpr const char* kWalls = "SEMANTIC_WALLS";
inline constexpr const char* kRooms = "SEMANTIC_ROOMS";
inline constexpr const char* kDoors = "SEMANTIC_DOORS";
inline constexpr const char* kObjects = "SEMANTIC_OBJECTS";
inline constexpr const char* kPlaces = "SEMANTIC_PLACES";
inline constexpr const char* kQuery = "QUERY";
inline constexpr const char* kAnswer = "ANSWER";
inline constexpr const char* kStatus = "STATUS";
inline constexpr const char* kParameters = "PARAMETERS";
inline constexpr const char* kCommand = "COMMAND";
inline constexpr const char* kPlayback = "PLAYBACK";
inline constexpr const char* kPlaybackCommand = "PLAYBACK_COMMAND";
inline constexpr const char* kSimState = "SIM_STATE";
inline constexpr const char* kSimInfo = "SIM_INFO";

/// What a log may feed in again; whatever else is in it is the result of an earlier run.
inline constexpr const char* const from_logs[] = {kLaser, kOdometry, kIns, kSensorInfo, kGroundTruth, kSimInfo};

}  // namespace modslam::channel
