#include "feel_options.h"

#include "commands.h"

namespace tactum {

void add_what_is_felt(CLI::App* command, FeelOptions* options) {
  command->footer(
      "Exit codes: 0 done, 1 an error (with --strict a remark on the scene as well), 2 a goal of the scene "
      "was "
      "not met, or the command line is wrong.");
  command
      ->add_option("SCENE", options->scenes,
                   "The name of a scene (tactum scenes lists them), a scene file, a URDF or MJCF file "
                   "(.urdf, .xml), or "
                   "one or two meshes: one is felt against a plate, the second of two against the first")
      ->expected(1, 2)
      ->capture_default_str();
  command->add_option("--save-scene", options->save_scene,
                      "Write the scene that was made of the meshes to this file");
  command->add_option("--tool", options->tool, "The body of a URDF or MJCF file that the hand holds");
  command->add_flag("--strict", options->strict, "Treat remarks on the scene as errors");
  command
      ->add_option("--duration", options->duration_s,
                   "Run for so many seconds; by default as long as the hand's motion")
      ->check(number_between(1e-3, 1e7, "seconds"));
  command->add_option("--updates", options->updates, "Run so many frames, instead of a duration")
      ->check(whole_number_between(1, 1e12, "a number of frames"))
      ->excludes("--duration");
  command
      ->add_option("--device", options->devices,
                   "The device (tactum devices lists them; touch is short for simulated:touch); by "
                   "default the simulated one "
                   "of the scene. In a scene with several tools once for each, in their order")
      ->allow_extra_args(false);
  command->add_option("--hand", options->hand, "The grip of the simulated hand: loose, medium or firm");
  command
      ->add_option("--response", options->response,
                   "How contacts push: constraint (no interpenetration) or penalty (the published springs); "
                   "by default as "
                   "the scene says")
      ->check(one_word_of({"constraint", "penalty"}));
  command->add_option("--settings", options->settings,
                      "Put the settings of this file over those of the scene; the page saves such files");
  command->add_option("--json", options->json, "Write the summary to this file (- for standard output)");
}

CLI::Option* add_record(CLI::App* command, FeelOptions* options) {
  return command
      ->add_option(
          "--record", options->record,
          "Record the run, with its scene and parts, in this file (docs/recording.md); tactum replay "
          "repeats it to the bit")
      ->check([](const std::string& path) {
        return path.ends_with(".mcap") ? std::string() : "expected a name that ends in .mcap, found " + path;
      });
}

CLI::Option* add_trace(CLI::App* command, FeelOptions* options) {
  CLI::Option* trace = command
                           ->add_option("--trace", options->trace,
                                        "Write every frame to this CSV file, a column for each quantity "
                                        "(docs/trace.md)")
                           ->check([](const std::string& path) {
                             return path.ends_with(".csv")
                                        ? std::string()
                                        : "expected a name that ends in .csv, found " + path;
                           });
  command
      ->add_flag("--trace-bodies", options->trace_bodies,
                 "Write the pose and twist of every body to the trace as well")
      ->needs(trace);
  return trace;
}

CLI::Option* add_bridge(CLI::App* command, FeelOptions* options) {
  CLI::Option* bridge =
      command
          ->add_option("--bridge", options->bridge.bridges,
                       "Tell the run to other programs while it goes on (docs/bridges.md): rosbridge, "
                       "foxglove, or one of them with :PORT; once for each bridge")
          ->allow_extra_args(false)
          ->check([](const std::string& text) {
            const Result<BridgeChoice> choice = parse_bridge(text);
            return choice ? std::string() : choice.error().message();
          });
  command
      ->add_option("--bridge-rate", options->bridge.rate_Hz,
                   "Messages a second on each topic of the bridges, at most; by default 100")
      ->check(number_between(0.1, 1e5, "messages a second"))
      ->needs(bridge);
  return bridge;
}

CLI::Option* add_page(CLI::App* command, FeelOptions* options, CLI::Option* view) {
  command->add_option("--port", options->port, "The port of the page; by default one that is free")
      ->check(whole_number_between(1, 65535, "a port"))
      ->needs(view);
  return command
      ->add_option("--wait", options->wait_s,
                   "How long a run with an end waits for a page to be opened, once its frames are over [s]")
      ->check(number_between(0.0, 1e5, "seconds"))
      ->needs(view);
}

}  // namespace tactum
