#include "apps/orb360/live_view.h"

#include <iostream>

#include "apps/orb360/interrupt.h"
#include "slam/viewer/run_resources.h"
#ifdef ORB360_HAS_LIBWEBSOCKETS
#include "slam/viewer/http_server.h"
#endif
#include <orb360/nn/base/check.h>

namespace orb360 {

#ifdef ORB360_HAS_LIBWEBSOCKETS
LiveView::LiveView(const std::string& address, int port) {
  ResourceTable table = PageResources(true);
  table.merge(feed_.Resources());
  server_ = std::make_unique<HttpServer>(std::move(table), HttpAddress{address, port, "--view=N"});
  std::cout << "this run is at " << server_->url() << std::endl;
}
#else
class HttpServer {};
LiveView::LiveView(const std::string& /*address*/, int /*port*/) {
  throw UserError(
      "--view: this orb360 was built without the viewer's server; install libwebsockets-dev and "
      "build with -DORB360_WITH_LIBWEBSOCKETS=ON");
}
#endif

LiveView::~LiveView() = default;

void LiveView::Watch(System* system) {
  system->Watch([this](const PresentState& state) { feed_.Take(state); });
}

bool LiveView::WaitForTurn() {
  return feed_.WaitForTurn([] { return CaughtInterrupt() != 0; });
}

}  // namespace orb360
