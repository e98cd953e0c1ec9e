// apps/flirt/memory.hpp: how much memory this process takes.
#pragma once

namespace flirt::app {

/// MB now in use (resident); 0 where the system does not tell.
double resident_mb();
/// The most that was in use since the last `forget_peak`, MB; 0 where the system does not tell.
double peak_mb();
void forget_peak();

}  // namespace flirt::app
