#pragma once

namespace orb360 {

/// From this call on the first SIGINT (Ctrl-C) or SIGTERM is recorded and does not end the program.
/// The second one ends it as usual.
void CatchInterrupts();

/// Returns the signal that was caught, or 0.
int CaughtInterrupt();

}  // namespace orb360
