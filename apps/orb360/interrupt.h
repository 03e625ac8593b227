#pragma once

namespace orb360 {

/// From this call on the first SIGINT (Ctrl-C) or SIGTERM is recorded and does not end the program.
/// The second one ends it as usual.
void CatchInterrupts();

/// Returns the signal that was caught, or 0.
int CaughtInterrupt();

/// Ends work that an interrupt has stopped.
struct Interrupted {};

/// Throws Interrupted if a signal was caught.
inline void ThrowIfInterrupted() {
  if (CaughtInterrupt() != 0) throw Interrupted();
}

}  // namespace orb360
