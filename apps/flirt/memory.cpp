#include "apps/flirt/memory.hpp"

#include <fstream>
#include <string>

namespace flirt::app {
namespace {

double status_mb(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kilobytes = 0;
    if (word == key && status >> kilobytes) { return kilobytes / 1024; }
  }
  return 0;
}

}  // namespace

double resident_mb() {
  return status_mb("VmRSS:");
}
double peak_mb() {
  return status_mb("VmHWM:");
}
void forget_peak() {
  std::ofstream("/proc/self/clear_refs") << "5";
}

}  // namespace flirt::app
