#include <cmath>
#include <iostream>
#include <memory>
#include <string>

#include "apps/orb360/commands.h"
#include "apps/orb360/compared_run.h"
#include "apps/orb360/interrupt.h"
#include "apps/orb360/report_file.h"
#include "apps/orb360/viewed_run.h"

namespace orb360 {
namespace {

struct Arguments {
  std::string run;
  std::string compare;  // "": nothing
  std::string out;      // "": report.html of the run
  ReportOptions options = {.check = ThrowIfInterrupted};
};

int Report(const Arguments& arguments) try {
  CatchInterrupts();
  ViewedRun run = OpenViewedRun(arguments.run, true);
  if (!arguments.compare.empty()) CompareWith(arguments.compare, &run);
  const std::filesystem::path out = arguments.out.empty()
                                        ? std::filesystem::path(arguments.run) / kReportName
                                        : std::filesystem::path(arguments.out);
  const std::uintmax_t size = WriteReport(run, arguments.options, out);
  std::cout << "wrote " << out.string() << ", "
            << std::lround(static_cast<double>(size) / 1e5) / 10.0 << " MB" << std::endl;
  return EXIT_SUCCESS;
} catch (const Interrupted&) {
  return 128 + CaughtInterrupt();  // as shells report it
}

}  // namespace

void AddReportCommand(CLI::App* app, Command* chosen) {
  CLI::App* command =
      app->add_subcommand("report", "Write a finished run as one file that a browser shows");
  const auto arguments = std::make_shared<Arguments>();
  ReportOptions& options = arguments->options;
  command->add_option("RUN", arguments->run, "Folder of a run")->required()->type_name("DIR");
  command->add_option("--compare", arguments->compare, kCompareHelp)->type_name("PATH");
  command->add_option("--out", arguments->out, "File to write (default: DIR/report.html)")
      ->type_name("FILE");
  command
      ->add_option("--max-size", options.max_mb, "Largest size of the file; the cloud is thinned")
      ->check(CLI::Range(2.0, 1000.0))
      ->check(kIsNumber)
      ->type_name("MB")
      ->capture_default_str();
  command
      ->add_option("--views", options.views,
                   "Images of keyframes in the file, where the run kept them (--save-views)")
      ->check(CLI::Range(0, 1000))
      ->type_name("N")
      ->capture_default_str();
  command->callback([arguments, chosen] { *chosen = [arguments] { return Report(*arguments); }; });
}

}  // namespace orb360
