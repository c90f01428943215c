// What explains the `lanternfish` program: help, the manual, completion, and words for what was misspelt.
#include <gmock/gmock.h>
#include <sys/wait.h>

#include <cstring>

#include "tests/unit/app/printed_files.hpp"
#include "tests/unit/app/program.hpp"

namespace lf::app {

namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

const std::vector<std::string> commands{"run",        "campaign", "serve",  "render-frames", "scenarios", "reach",   "peaks",
                                        "plane",      "markers",  "ik",     "bench",         "doctor",    "version", "help",
                                        "completion", "compare",  "export", "check",         "new"};

class Help : public Program {
 protected:
  // What bash offers for the words of a command line, the last of which is being typed.
  std::vector<std::string> completed(const std::string& script, const std::string& function, const std::vector<std::string>& words) const {
    std::string line =
        "PATH=" + std::filesystem::path(LANTERNFISH_PROGRAM).parent_path().string() + ":$PATH\nsource '" + script + "'\nCOMP_WORDS=(";
    for (const std::string& word : words) line += "'" + word + "' ";
    line += ")\nCOMP_CWORD=" + std::to_string(words.size() - 1) + "\n" + function + " 2>/dev/null\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n";
    file("ask.bash", line);
    EXPECT_EQ(std::system(("cd '" + folder().string() + "' && bash ask.bash >offered").c_str()), 0);
    std::vector<std::string> offered;
    std::ifstream in(folder() / "offered");
    for (std::string one; std::getline(in, one);) offered.push_back(one);
    return offered;
  }
};

TEST_F(Help, OfACommandIsThatCommandsHelp) {
  for (const std::string& command : commands) {
    const Said said = run("help " + command);
    EXPECT_EQ(said.status, 0) << command;
    EXPECT_EQ(said.out, run(command + " --help").out) << command;
  }
  EXPECT_EQ(run("help").out, run("--help").out);
  const Said unknown = run("help rnu");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_EQ(unknown.err, "lanternfish: no command 'rnu'; did you mean 'run'?\n");
  EXPECT_EQ(run("help hydraulics").err, "lanternfish: no command 'hydraulics'; `lanternfish --help` lists them\n");
}

TEST_F(Help, AMisspeltOptionIsAnsweredWithTheNearest) {
  const auto said = [&](const std::string& arguments) {
    const Said answer = run(arguments);
    EXPECT_EQ(answer.status, 2) << arguments;
    return answer.err;
  };
  EXPECT_EQ(said("run --sed 3"), "lanternfish: lanternfish run has no option '--sed'; did you mean '--seed'?\n");
  EXPECT_EQ(said("run --render-thread=2"),
            "lanternfish: lanternfish run has no option '--render-thread'; did you mean '--render-threads'?\n");
  EXPECT_THAT(said("peaks x.png --overly y.png"), HasSubstr("did you mean '--overlay'?"));
  EXPECT_THAT(said("run --hydraulic-oil 3"), HasSubstr("`lanternfish run --help` lists those it has"));
  // The option that was meant is the one that is then missing: the cause is told, not the consequence.
  EXPECT_THAT(said("serve --cna can0"), HasSubstr("has no option '--cna'; did you mean '--can'?"));
  EXPECT_THAT(said("ik --x 0.3 --y 0 --zz 0.5"), HasSubstr("did you mean '--z'?"));
}

// The reader is gone before a byte is written: what `head` does when it has read enough.
TEST_F(Help, AReaderThatWentAwayIsNoError) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  close(ends[0]);
  for (const char* command : {"scenarios --schema", "scenarios", "version --json", "help", "ik --x 2 --y 0 --z 0"}) {
    const pid_t child = fork();
    if (child == 0) {
      dup2(ends[1], STDOUT_FILENO);
      const std::string line = "exec " LANTERNFISH_PROGRAM " " + std::string(command) + " 2>'" + (folder() / "err").string() + "'";
      execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
      _exit(127);
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_TRUE(WIFEXITED(status)) << command;
    EXPECT_EQ(WEXITSTATUS(status), std::strncmp(command, "ik", 2) == 0 ? 1 : 0) << command << ": its own status";
    EXPECT_EQ(text_of(folder() / "err"), "") << command;
  }
  close(ends[1]);
}

TEST_F(Help, ManualPagesAreWhatTheProgramPrints) {
  expect_in_repository("docs/man/lanternfish.1", run("help --man 1").out);
  expect_in_repository("docs/man/lanternfish-scenario.5", run("help --man 5").out);
  EXPECT_THAT(run("help --man 7").err, HasSubstr("there is no page in section '7'; there are 1, 5"));
}

// Against what CLI11 prints, which the page's writer does not read.
TEST_F(Help, TheManualHasEveryCommandAndOption) {
  const std::string page = run("help --man 1").out;
  for (const std::string& command : commands) {
    const std::string part = part_of(page, ".SS " + in_roff(command));
    EXPECT_NE(part, "") << command;
    for (const std::string& option : options_in(run(command + " --help").out)) {
      if (option == "--help") continue;
      EXPECT_THAT(part, HasSubstr("\n.B " + in_roff(option))) << command;
    }
  }
  EXPECT_THAT(part_of(page, ".SS run"), HasSubstr("\n.B \\-\\-json\n")) << "a flag takes no value";
  EXPECT_THAT(part_of(page, ".SS run"), HasSubstr("\n.B \\-\\-seed N\nDraws everything random. Default: 1.\n"));
  // And no command that there is not.
  std::size_t parts = 0;
  for (std::size_t at = page.find("\n.SS "); at != std::string::npos; at = page.find("\n.SS ", at + 1)) ++parts;
  EXPECT_EQ(parts, commands.size());
}

TEST_F(Help, TheScenariosPageHasEveryKeyWithItsDefault) {
  const std::string page = run("help --man 5").out;
  std::istringstream table(run("scenarios --keys").out);  // "| `key` | takes | `default` | ..."
  int keys = 0;
  for (std::string row; std::getline(table, row);) {
    if (!row.starts_with("| `") || row.starts_with("| `tasks[]") || row.starts_with("| `faults[]")) continue;
    const std::string key = row.substr(3, row.find('`', 3) - 3);
    std::size_t at = row.find(" | `", 3) + 4;
    const std::string usual = row.substr(at, row.find("` |", at) - at);
    const std::size_t place = page.find("\n.B " + key + "\n");
    ASSERT_NE(place, std::string::npos) << key;
    EXPECT_THAT(page.substr(place, page.find("\n.TP", place) - place), HasSubstr("Default: " + in_roff(usual))) << key;
    ++keys;
  }
  EXPECT_GT(keys, 80);
}

// groff warns of an unknown request or font, a line that cannot be broken, an unended block.
TEST_F(Help, TheManualIsWellFormed) {
  if (std::system("command -v groff >/dev/null") != 0) GTEST_SKIP() << "missing: apt-get install groff";
  for (const char* page : {"lanternfish.1", "lanternfish-scenario.5", "lanternfishd.8", "lanternfish-vehicle.5"}) {
    const std::string groff = "groff -man -Tutf8 -ww -rLL=100n " LANTERNFISH_SOURCE_DIR "/docs/man/";
    ASSERT_EQ(std::system((groff + page + " >'" + (folder() / "text").string() + "' 2>'" + (folder() / "warnings").string() + "'").c_str()),
              0);
    EXPECT_EQ(text_of(folder() / "warnings"), "") << page;
    EXPECT_GT(text_of(folder() / "text").size(), 5000u) << page;
  }
}

TEST_F(Help, TheUsersPageHasEveryCommand) {
  const std::string page = text_of(LANTERNFISH_SOURCE_DIR "/docs/commands.md");
  for (const std::string& command : commands) EXPECT_THAT(page, HasSubstr("| `" + command)) << command;
}

TEST_F(Help, CompletionIsWhatThePackageHas) {
  expect_in_repository("toolchain/completion/lanternfish.bash", run("completion bash").out);
  expect_in_repository("toolchain/completion/_lanternfish", run("completion zsh").out);
  EXPECT_EQ(run("completion fish").status, 2);
  EXPECT_EQ(run("completion").status, 2);
}

TEST_F(Help, BashCompletesCommandsOptionsScenariosAndKeys) {
  const std::string script = file("completion", run("completion bash").out);
  const auto offered = [&](const std::vector<std::string>& words) { return completed(script, "_lanternfish", words); };
  EXPECT_THAT(offered({"lanternfish", "ca"}), ::testing::ElementsAre("campaign"));
  EXPECT_THAT(offered({"lanternfish", ""}), ::testing::AllOf(Contains("run"), Contains("--version")));
  EXPECT_THAT(offered({"lanternfish", "run", "--se"}), ::testing::UnorderedElementsAre("--seed", "--set"));
  EXPECT_THAT(offered({"lanternfish", "run", "turn"}), Contains("turn_only"));
  EXPECT_THAT(offered({"lanternfish", "run", "--set", "valve.fr"}), ::testing::ElementsAre("valve.friction_nm="));
  EXPECT_THAT(offered({"lanternfish", "peaks", "--axis", ""}), ::testing::UnorderedElementsAre("column", "row"));
  EXPECT_THAT(offered({"lanternfish", "run", "--seed", ""}), ::testing::ElementsAre("")) << "a number";
  file("on.png", "");
  EXPECT_THAT(offered({"lanternfish", "peaks", "on"}), Contains("on.png"));
  EXPECT_THAT(offered({"lanternfish", "help", "re"}), ::testing::UnorderedElementsAre("render-frames", "reach"));
  EXPECT_THAT(offered({"lanternfish", "campaign", "default", "--seeds", ""}), ::testing::ElementsAre(""));
}

// In zsh itself, by its own functions: what is offered is what compadd was given.
TEST_F(Help, ZshReadsTheCompletion) {
  if (std::system("command -v zsh >/dev/null") != 0) GTEST_SKIP() << "missing: apt-get install zsh";
  for (const char* name : {"_lanternfish", "_lanternfishd"}) {
    const std::string script = std::string(LANTERNFISH_SOURCE_DIR "/toolchain/completion/") + name;
    EXPECT_EQ(std::system(("zsh -n '" + script + "'").c_str()), 0) << name;
  }
}

}  // namespace

}  // namespace lf::app
