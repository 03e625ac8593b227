#pragma once

namespace orb360 {

/// From now on the first SIGINT (Ctrl-C) or SIGTERM is remembered instead of ending the program;
/// the second ends it as usual.
void CatchInterrupts();

/// The signal that was caught, 0 if none.
int CaughtInterrupt();

}  // namespace orb360
