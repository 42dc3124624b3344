/// The names of all channels. lcmtypes/README.md lists their types, rates and owners.
#pragma once

#include <array>
#include <string_view>

namespace lab::channels {

inline constexpr std::string_view kRobotCommand = "ROBOT_COMMAND";
inline constexpr std::string_view kRobotStop = "ROBOT_STOP";
inline constexpr std::string_view kRobotSenses = "ROBOT_SENSES";
inline constexpr std::string_view kRobotStatus = "ROBOT_STATUS";
inline constexpr std::string_view kRobotSteps = "ROBOT_STEPS";
inline constexpr std::string_view kRobotCalibration = "ROBOT_CALIBRATION";
inline constexpr std::string_view kCalibrationStatus = "CALIBRATION_STATUS";
inline constexpr std::string_view kTrackedFrame = "TRACKED_FRAME";
inline constexpr std::string_view kTrackedDetails = "TRACKED_DETAILS";
inline constexpr std::string_view kTrackerStatus = "TRACKER_STATUS";
inline constexpr std::string_view kLightCommand = "LIGHT_COMMAND";
inline constexpr std::string_view kLightStatus = "LIGHT_STATUS";
inline constexpr std::string_view kLightSeen = "LIGHT_SEEN";
inline constexpr std::string_view kLightDelivery = "LIGHT_DELIVERY";
inline constexpr std::string_view kLinkStatus = "LINK_STATUS";
inline constexpr std::string_view kAnalysis = "ANALYSIS";
inline constexpr std::string_view kCollective = "COLLECTIVE";
inline constexpr std::string_view kServiceStatus = "SERVICE_STATUS";
inline constexpr std::string_view kExperimentEvent = "EXPERIMENT_EVENT";
inline constexpr std::string_view kExperimentCommand = "EXPERIMENT_COMMAND";
inline constexpr std::string_view kExperimentStatus = "EXPERIMENT_STATUS";
inline constexpr std::string_view kClock = "CLOCK";
inline constexpr std::string_view kSimTruth = "SIM_TRUTH";

inline constexpr std::array kAll{
    kRobotCommand,      kRobotStop,       kRobotStatus,       kRobotSteps,       kRobotCalibration,
    kCalibrationStatus, kTrackedFrame,    kTrackedDetails,    kTrackerStatus,    kLightCommand,
    kLightStatus,       kLightSeen,       kLightDelivery,     kLinkStatus,       kAnalysis,
    kServiceStatus,     kExperimentEvent, kExperimentCommand, kExperimentStatus, kClock,
    kSimTruth,          kRobotSenses,     kCollective};

/// LCM's own probe, which every starting subscriber sends to itself. It is ignored.
inline constexpr std::string_view kLcmSelfTest = "LCM_SELF_TEST";

}  // namespace lab::channels
