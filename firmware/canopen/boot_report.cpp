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
    case BootFailure::wrong_readback: return "object does not hold what was written";
    case BootFailure::wrong_length: return "object has another length than the standard's";
    case BootFailure::rebooted: return "rebooted while being configured";
    case BootFailure::not_operational: return "did not become operational";
    case BootFailure::no_process_data: return "operational without process data";
  }
  return "unknown";
}

}  // namespace lf::canopen
