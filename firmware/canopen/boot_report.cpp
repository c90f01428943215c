#include "firmware/canopen/boot_report.hpp"

namespace lf::canopen {

const char* name(BootFailure failure) {
  switch (failure) {
    case BootFailure::none: return "none";
    case BootFailure::configuration: return "configuration is not valid";
    case BootFailure::no_boot_up: return "no boot-up message after reset";
    case BootFailure::sdo_aborted: return "SDO transfer refused";
    case BootFailure::sdo_timeout: return "no answer to SDO";
    case BootFailure::wrong_identity: return "another device than expected";
    case BootFailure::wrong_setting: return "object does not hold what the drive's profile says";
    case BootFailure::no_rating: return "rated torque 6076 is 0";
    case BootFailure::wrong_rating: return "rated torque 6076 is not the stated one";
    case BootFailure::other_motor: return "rated torque 6076 is of another motor than the arm's description has";
    case BootFailure::read_only: return "object holds another value and cannot be written";
    case BootFailure::wrong_readback: return "object does not hold what was written";
    case BootFailure::wrong_length: return "object has another length than the standard's";
    case BootFailure::rebooted: return "rebooted while being configured";
    case BootFailure::not_operational: return "did not become operational";
    case BootFailure::no_process_data: return "operational without process data";
  }
  return "unknown";
}

const char* name(Substitute substitute) {
  switch (substitute) {
    case Substitute::none: return "none";
    case Substitute::other_object: return "another object of the drive";
    case Substitute::vendor_limit: return "the maker's own limit, set when the drive is commissioned";
    case Substitute::master_limits_speed: return "the master limits the speed of its targets";
    case Substitute::master_limits_position: return "the master refuses targets outside of the limits";
    case Substitute::master_times_following: return "the master times the following error";
    case Substitute::no_feed_forward: return "no torque feed-forward";
    case Substitute::configured_rating: return "the rated torque of the machine's file";
    case Substitute::node_guarding: return "node guarding";
    case Substitute::fixed_by_maker: return "the drive's own behaviour, see its profile";
  }
  return "unknown";
}

}  // namespace lf::canopen
