#pragma once

#include <memory>
#include <optional>
#include <string>

#include "slam/viewer/live_feed.h"
#include <orb360/slam/pipeline/system.h>

namespace orb360 {

class HttpServer;

/// Shows a run in a browser while it goes on (`orb360 run --view`).
class LiveView {
 public:
  /// Starts a server and prints its address. Throws UserError where the port is taken, or the
  /// program was built without a server.
  LiveView(const std::string& address, int port);
  ~LiveView();

  /// Shows what the system tracks from now on.
  void Watch(System* system);
  /// Waits while the user has paused the run. False where the user has ended it.
  bool WaitForTurn();
  /// What is shown after the last frame (LiveFeed).
  LiveFeed& feed() { return feed_; }

 private:
  LiveFeed feed_;
  std::unique_ptr<HttpServer> server_;  ///< Destroyed first: its resources refer to the feed.
};

}  // namespace orb360
