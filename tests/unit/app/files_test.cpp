// Where `lanternfish` finds files and in which form it writes them.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/unit/app/program.hpp"

namespace lf::app {

namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class Files : public Program {};

TEST_F(Files, ReachWritesThePictureThatItsNameSays) {
  EXPECT_EQ(run("reach --draws 1 --out r.jpg").status, 0);
  EXPECT_THAT(text_of(folder() / "r.jpg"), StartsWith("\xFF\xD8\xFF"));
  EXPECT_EQ(run("reach --draws 1 --out r.JPEG").status, 0);
  EXPECT_THAT(text_of(folder() / "r.JPEG"), StartsWith("\xFF\xD8\xFF"));
  for (const char* name : {"r.png", "r"}) {
    EXPECT_EQ(run(std::string("reach --draws 1 --out ") + name).status, 0);
    EXPECT_THAT(text_of(folder() / name), StartsWith("\x89PNG\r\n")) << name;
  }
  const Said gif = run("reach --draws 1 --out r.gif");
  EXPECT_EQ(gif.status, 2);
  EXPECT_EQ(gif.err, "lanternfish: r.gif: the picture is written as .png or .jpg\n");
  EXPECT_FALSE(std::filesystem::exists(folder() / "r.gif"));
}

TEST_F(Files, PlaneReadsXyz) {
  std::string xyz = "//X Y Z\n400\n";
  for (int i = 0; i < 400; ++i) xyz += std::to_string(0.05 * (i % 20)) + " " + std::to_string(0.05 * (i / 20)) + " 0.5\n";
  const Said said = run("plane " + file("flat.xyz", xyz) + " --json");
  ASSERT_EQ(said.status, 0) << said.err;
  const auto plane = nlohmann::json::parse(said.out);
  EXPECT_EQ(plane["inliers"], 400);
  EXPECT_NEAR(std::abs(double(plane["offset_m"])), 0.5, 1e-6);
  EXPECT_THAT(run("plane " + file("short.xyz", "5\n1 2 3\n")).err, HasSubstr("has 1 points, not the 5 that its first line says"));
}

TEST_F(Files, NumbersThatNoArmReachesAreToldInWords) {
  for (const char* where :
       {"--x 1e308 --y 0 --z 0.5", "--x 1e308 --y 1e308 --z 1e308", "--x 0.3 --y 0 --z -1e308", "--x 1e200 --y -1e200 --z 0"}) {
    const Said said = run(std::string("ik ") + where);
    EXPECT_EQ(said.status, 2) << said.out;
    EXPECT_EQ(said.out, "");
    EXPECT_THAT(said.err, HasSubstr("takes a number from -1000 to 1000")) << where;
  }
  const Said far = run("ik --x 1000 --y 0 --z 0.5");
  EXPECT_EQ(far.status, 1);
  EXPECT_THAT(far.out, ::testing::ContainsRegex("not reachable: .* by 99[0-9]{4}\\.[0-9] mm"));
}

// The scenario stands in another folder, which is looked in second.
TEST_F(Files, AFileOfSetIsLookedForInThePresentFolderFirst) {
  std::filesystem::create_directories(folder() / "scenes");
  file("scenes/s.yaml", "time_limit_s: 1\n");
  const std::string bad = "<robot name=\"none\">\n</robot>\n";
  file("six.urdf", bad);
  const Said here = run("run scenes/s.yaml --set arm.urdf=six.urdf");
  EXPECT_EQ(here.status, 2);
  EXPECT_THAT(here.err, HasSubstr((folder() / "six.urdf").string())) << here.err;
  std::filesystem::rename(folder() / "six.urdf", folder() / "scenes" / "six.urdf");
  EXPECT_THAT(run("run scenes/s.yaml --set arm.urdf=six.urdf").err, HasSubstr("scenes/six.urdf"));
  std::filesystem::remove(folder() / "scenes" / "six.urdf");
  EXPECT_THAT(run("run scenes/s.yaml --set arm.urdf=six.urdf").err, HasSubstr("there is no six.urdf in "));
  file("mine.yaml", "title: a drive of ours\n");
  EXPECT_THAT(run("run scenes/s.yaml --set drives.profile=mine.yaml").err, HasSubstr("mine.yaml"));
  file("epos4", "a file of the name of a shipped profile is none");
  EXPECT_EQ(run("scenarios scenes/s.yaml --set drives.profile=epos4").status, 0);
}

// The program's own compiled-in path is this checkout's: it used that one's files.
TEST_F(Files, ACheckoutThatWasCopiedUsesItsOwnFiles) {
  namespace fs = std::filesystem;
  const fs::path copy = folder() / "copy", bin = copy / "build" / "release" / "bin";
  fs::create_directories(bin);
  fs::copy_file(LANTERNFISH_PROGRAM, bin / "lanternfish");
  fs::copy(LANTERNFISH_SOURCE_DIR "/shared", copy / "shared", fs::copy_options::recursive);
  std::ofstream(copy / "shared" / "scenarios" / "only_here.yaml") << "description: only here\n";
  const auto scenarios_of = [&](const fs::path& program) {
    EXPECT_EQ(
        std::system(("cd '" + folder().string() + "' && env -u LANTERNFISH_SHARE '" + program.string() + "' scenarios >listed").c_str()),
        0);
    return text_of(folder() / "listed");
  };
  EXPECT_THAT(scenarios_of(bin / "lanternfish"), HasSubstr("only_here"));
  EXPECT_THAT(scenarios_of(LANTERNFISH_PROGRAM), ::testing::Not(HasSubstr("only_here")));
  // An installation inside of it has files of its own.
  fs::create_directories(copy / "usr" / "bin");
  fs::copy_file(LANTERNFISH_PROGRAM, copy / "usr" / "bin" / "lanternfish");
  fs::create_directories(copy / "usr" / "share");
  fs::copy(LANTERNFISH_SOURCE_DIR "/shared", copy / "usr" / "share" / "lanternfish", fs::copy_options::recursive);
  EXPECT_THAT(scenarios_of(copy / "usr" / "bin" / "lanternfish"), ::testing::Not(HasSubstr("only_here")));
}

// The codecs' library of a copied program: damaged, another's, missing, and the right one.
class Codecs : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    const std::filesystem::path program = LANTERNFISH_PROGRAM;
    std::filesystem::create_directories(folder() / "bin");
    std::filesystem::create_directories(folder() / "lib");
    std::filesystem::copy_file(program, folder() / "bin/lanternfish");
    library_ = text_of(program.parent_path().parent_path() / "lib/lanternfish_codecs.so");
  }
  Said doctor() const { return run("doctor", R"(sh -c 'exec bin/lanternfish "$@"')"); }
  std::string library_;
};

TEST_F(Codecs, ThatAreDamagedOrMissingAreToldAndEndNothing) {
  ASSERT_GT(library_.size(), 10'000u);
  EXPECT_THAT(doctor().out, HasSubstr("lib/lanternfish_codecs.so is there"));
  for (const std::string& damaged :
       {std::string(), std::string("text"), library_.substr(0, 5'000), library_.substr(0, library_.size() - 1)}) {
    file("lib/lanternfish_codecs.so", damaged);
    const Said said = doctor();
    EXPECT_EQ(said.status, 3) << damaged.size();
    EXPECT_THAT(said.out, HasSubstr("is no library of this kind of processor, or is cut off"));
  }
  file("lib/lanternfish_codecs.so", library_);
  EXPECT_EQ(doctor().status, 0) << doctor().out;
}

}  // namespace

}  // namespace lf::app
