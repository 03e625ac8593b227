#include <chrono>
#include <iostream>
#include <memory>
#include <string>
#include <thread>

#include "apps/orb360/commands.h"
#include "apps/orb360/compared_run.h"
#include "apps/orb360/interrupt.h"
#include "apps/orb360/viewed_run.h"
#include "slam/viewer/run_resources.h"
#ifdef ORB360_HAS_LIBWEBSOCKETS
#include "slam/viewer/http_server.h"
#include "slam/viewer/listen_address.h"
#endif
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

struct ViewOptions {
  std::string run;
  std::string compare;  // "": nothing
  std::string address = "127.0.0.1";
  int port = 8360;
};

int View(const ViewOptions& options) try {
#ifdef ORB360_HAS_LIBWEBSOCKETS
  RequireFree(options.address, options.port, "--port N");  // before minutes of work
  CatchInterrupts();
  ViewedRun run = OpenViewedRun(options.run, false);
  if (!options.compare.empty()) {
    CompareWith(options.compare, &run);
    AddOtherCloud(options.compare, &run);
  }
  for (const std::string& missing : run.scene.missing)
    std::cout << "not there: " << missing << '\n';
  const RunImages images{run.scene.images,
                         [&run](int frame) { return LoadInputImage(run, frame); }};
  const HttpServer server(RunResources(SceneJson(run.scene), run.octree, images, run.views,
                                       run.scene.views, run.other_octree),
                          {options.address, options.port});
  std::cout << options.run << " is at " << server.url() << "\nCtrl-C ends it" << std::endl;
  constexpr std::chrono::milliseconds kStep(50);
  while (CaughtInterrupt() == 0) std::this_thread::sleep_for(kStep);
  return EXIT_SUCCESS;
#else
  throw UserError(options.run +
                  ": this orb360 was built without the viewer's server; install "
                  "libwebsockets-dev and build with -DORB360_WITH_LIBWEBSOCKETS=ON, or use `orb360 "
                  "report`");
#endif
} catch (const Interrupted&) {
  return 128 + CaughtInterrupt();  // as shells report it
}

}  // namespace

void AddViewCommand(CLI::App* app, Command* chosen) {
  CLI::App* command = app->add_subcommand("view", "Show a finished run in a browser");
  const auto options = std::make_shared<ViewOptions>();
  command->add_option("RUN", options->run, "Folder of a run")->required()->type_name("DIR");
  command->add_option("--compare", options->compare, kCompareHelp)->type_name("PATH");
  command->add_option("--port", options->port, "Port to listen at; 0: any that is free")
      ->check(CLI::Range(0, 65535))
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option("--view-address", options->address,
                   "Address to listen at. Beyond this machine (0.0.0.0: everywhere) the address "
                   "that is printed has a random token, without which nobody is answered")
      ->type_name("ADDR")
      ->capture_default_str();
  command->callback([options, chosen] { *chosen = [options] { return View(*options); }; });
}

}  // namespace orb360
