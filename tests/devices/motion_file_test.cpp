#include "tactum/devices/motion_file.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <sstream>

#include "tactum/base/random.h"
#include "tactum/math/rotation.h"
#include "tactum/math/screw.h"

namespace tactum {
namespace {

namespace fs = std::filesystem;

/// A file with this text, removed at the end of the test.
class TextFile {
 public:
  explicit TextFile(const std::string& text)
      : path_(fs::path(testing::TempDir()) /
              (std::string("tactum_") + testing::UnitTest::GetInstance()->current_test_info()->name() + "_" +
               std::to_string(++count_) + ".csv")) {
    std::ofstream(path_, std::ios::binary) << text;
  }
  ~TextFile() { fs::remove(path_); }
  TextFile(const TextFile&) = delete;
  TextFile& operator=(const TextFile&) = delete;
  std::string path() const { return path_.string(); }

 private:
  static inline int count_ = 0;
  fs::path path_;
};

/// The folder of shared real data, or empty.
fs::path data_folder() {
  const char* variable = std::getenv("TACTUM_DATA");
  const fs::path folder =
      variable ? fs::path(variable) : fs::path(TACTUM_SOURCE_DIR) / ".." / "shared" / "data";
  return fs::exists(folder) ? folder : fs::path();
}

const char* const kHeader = "time_s,x,y,z,qw,qx,qy,qz\n";

/// The message of the error this text gives.
std::string error_of(const std::string& text) {
  const TextFile file(text);
  const Result<Motion> motion = read_motion(file.path());
  if (motion) return "no error";
  const std::string message = motion.error().message();
  EXPECT_EQ(message.rfind(file.path(), 0), 0u) << message;
  return message.substr(std::min(file.path().size(), message.size()));
}

TEST(MotionFile, ReadsQuaternionsInAnyColumnOrder) {
  const TextFile file(
      "qw,note,qx,qy,qz,time_s,x,y,z,buttons\r\n"
      "1,7,0,0,0,10.5,1e-3,-2.5E-2,+0.25,0\r\n"
      "\r\n"
      "# a comment\r\n"
      "0.7071067811865476,8,0,0,0.7071067811865476,11.5,0,0,0,3\r\n");
  const Result<Motion> motion = read_motion(file.path());
  ASSERT_TRUE(motion) << motion.error().message();
  ASSERT_EQ(motion->X.size(), 2u);
  EXPECT_EQ(motion->start_time_s, 10.5);
  EXPECT_EQ(motion->time_s[0], 0.0);
  EXPECT_EQ(motion->time_s[1], 1.0);
  EXPECT_EQ(motion->X[0].p, Vec3(1e-3, -2.5e-2, 0.25));
  EXPECT_LT((motion->X[1].R * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-15);
  EXPECT_EQ(motion->buttons[1], 3u);
  EXPECT_EQ(motion->repairs.orthonormalized_rows, 0u);
}

TEST(MotionFile, ReadsMatricesRowMajor) {
  const TextFile file(
      "time_s,px,py,pz,m00,m01,m02,m10,m11,m12,m20,m21,m22\n"
      "0,0,0,1,0,-1,0,1,0,0,0,0,1");  // no line end
  const Result<Motion> motion = read_motion(file.path());
  ASSERT_TRUE(motion) << motion.error().message();
  EXPECT_EQ(motion->X[0].R * Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY()));
}

TEST(MotionFile, ReadsTheTumFormat) {
  const TextFile file("# timestamp tx ty tz qx qy qz qw\n5.0 1 2 3 0 0 0 1\n  5.5\t1 2 4 0 0 0.6 0.8 \n");
  const Result<Motion> motion = read_motion(file.path());
  ASSERT_TRUE(motion) << motion.error().message();
  EXPECT_EQ(motion->time_s[1], 0.5);
  EXPECT_EQ(motion->X[1].p.z(), 4.0);
  EXPECT_NEAR(log_rotation(motion->X[1].R).z(), 2.0 * std::atan2(0.6, 0.8), 1e-15);
}

TEST(MotionFile, ErrorsTellLineAndColumn) {
  const std::string header = kHeader;
  EXPECT_EQ(error_of(""), ": no row of numbers: found an empty file, expected at least one row");
  EXPECT_EQ(error_of(header), ": no row of numbers: found a header only, expected at least one row");
  EXPECT_EQ(error_of("time_s,x,y\n0,0,0\n"), ": missing column: expected a column named 'px'");
  EXPECT_EQ(error_of("x,y,z,qw,qx,qy,qz\n0,0,0,1,0,0,0\n"),
            ": missing column: expected a column named 'time_s'");
  EXPECT_EQ(error_of("time_s,x,x\n"), ":1: column named twice: found 'x', expected a name once");
  EXPECT_EQ(error_of(header + "0,0,0,0,1,0,0,0\n1,0,0,0,1,0,0\n"),
            ":3: wrong number of columns: found 7, expected 8");
  EXPECT_EQ(error_of(header + "0,0,nan,0,1,0,0,0\n"),
            ":2: column y: not a finite number: found 'nan', expected a finite number");
  EXPECT_EQ(error_of(header + "0,0,1e999,0,1,0,0,0\n"),
            ":2: column y: not a number: found '1e999', expected a finite number");
  EXPECT_EQ(error_of(header + "0,0,,0,1,0,0,0\n"),
            ":2: column y: not a number: found an empty cell, expected a finite number");
  EXPECT_EQ(error_of(header + "0,0,1.5mm,0,1,0,0,0\n"),
            ":2: column y: not a number: found '1.5mm', expected a finite number");
  EXPECT_NE(
      error_of(header + "1,0,0,0,1,0,0,0\n1,0,0,0,1,0,0,0\n").find(":3: column time_s: times must increase"),
      std::string::npos);
  EXPECT_NE(error_of(header + "0,0,0,0,1,0,0.2,0\n").find(":2: column qw: not a unit quaternion"),
            std::string::npos);
  EXPECT_NE(error_of("time_s,x,y,z,qw,qx,qy,qz,buttons\n0,0,0,0,1,0,0,0,1.5\n").find("not a button mask"),
            std::string::npos);
  EXPECT_NE(error_of("0 0 0 0 0 0 1\n").find(":1: wrong number of columns: found 7, expected 8"),
            std::string::npos);
  const Result<Motion> missing = read_motion("/nowhere/at/all.csv");
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message().find("cannot read the file"), std::string::npos);
  EXPECT_FALSE(read_motion(testing::TempDir())) << "a folder is no file";
}

TEST(MotionFile, RubbishIsRefusedAndNeverCrashes) {
  Random random(31);
  const std::string valid = std::string(kHeader) + "0,0,0,0,1,0,0,0\n1,0,0,0.5,1,0,0,0\n";
  for (int i = 0; i < 3000; ++i) {
    std::string text =
        valid.substr(0, static_cast<std::size_t>(random.index(static_cast<int>(valid.size()))));
    const int changes = random.index(4);
    for (int k = 0; k < changes && !text.empty(); ++k) {
      const int at = random.index(static_cast<int>(text.size()));
      text[at] = static_cast<char>(random.index(256));
    }
    const TextFile file(text);
    const Result<Motion> motion = read_motion(file.path());
    if (!motion) {
      EXPECT_FALSE(motion.error().message().empty()) << "seed 31, try " << i;
      continue;
    }
    for (const Pose& X : motion->X) EXPECT_TRUE(X.finite()) << "seed 31, try " << i;
  }
}

std::string two_body_file(const Mat3& R, int decimals) {
  std::ostringstream text;
  text << "frame,time_s";
  for (const char* body : {"o1_", "o2_"}) {
    text << "," << body << "px," << body << "py," << body << "pz";
    for (int k = 0; k < 9; ++k) text << "," << body << "m" << k / 3 << k % 3;
  }
  text << "\n" << std::fixed << std::setprecision(decimals) << "7,0.25,0,0,0,1,0,0,0,1,0,0,0,1,1,2,3";
  for (int k = 0; k < 9; ++k) text << "," << R(k / 3, k % 3);
  text << "\n";
  return text.str();
}

TEST(TwoBodyMotion, RoundedRotationsAreMendedAndCounted) {
  const Mat3 R = exp_rotation({0.3, -0.8, 1.1});
  const TextFile exact(two_body_file(R, 17));
  const Result<TwoBodyMotion> read = read_two_body_motion(exact.path());
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(read->frame[0], 7);
  EXPECT_EQ(read->repairs.orthonormalized_rows, 0u);
  EXPECT_TRUE(read->repairs.sentence(1).empty());
  EXPECT_LT((read->X_WB[0].R - R).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_EQ(read->X_WA[0].R, Mat3(Mat3::Identity()));

  const TextFile rounded(two_body_file(R, 6));
  const Result<TwoBodyMotion> mended = read_two_body_motion(rounded.path());
  ASSERT_TRUE(mended) << mended.error().message();
  EXPECT_EQ(mended->repairs.orthonormalized_rows, 1u);
  EXPECT_GT(mended->repairs.worst_deviation, 1e-8);
  EXPECT_NE(mended->repairs.sentence(1).find("1 of 1 rows"), std::string::npos);
  const Mat3& M = mended->X_WB[0].R;
  EXPECT_LT((M * M.transpose() - Mat3::Identity()).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_LT((M - R).cwiseAbs().maxCoeff(), 1e-6);

  const TextFile stretched(two_body_file(1.001 * R, 17));
  const Result<TwoBodyMotion> refused = read_two_body_motion(stretched.path());
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message().find(":2: column o2_m00: not a rotation matrix"), std::string::npos)
      << refused.error().message();

  Mat3 mirrored = R;
  mirrored.col(0) *= -1.0;
  const TextFile reflection(two_body_file(mirrored, 17));
  EXPECT_FALSE(read_two_body_motion(reflection.path()));
}

TEST(TwoBodyMotion, ReadsTheSharedReferenceMotions) {
  const fs::path data = data_folder();
  if (data.empty()) {
    std::printf("shared data absent (set TACTUM_DATA): reference motions not read\n");
    GTEST_SKIP() << "shared data absent";
  }
  int files = 0;
  for (const char* folder : {"reference", "fcl_contact_models"}) {
    for (const fs::directory_entry& entry : fs::directory_iterator(data / folder)) {
      if (entry.path().filename().string().find("_motion.csv") == std::string::npos) continue;
      ++files;
      const Result<TwoBodyMotion> motion = read_two_body_motion(entry.path().string());
      ASSERT_TRUE(motion) << motion.error().message();
      EXPECT_EQ(motion->repairs.orthonormalized_rows > 0, std::string(folder) == "fcl_contact_models");
      EXPECT_LT(motion->repairs.worst_deviation, 1e-5);
      for (const Pose& X : motion->X_WB) {
        ASSERT_LT((X.R * X.R.transpose() - Mat3::Identity()).cwiseAbs().maxCoeff(), 1e-14);
      }
      std::printf("%s: %zu rows; %s\n", entry.path().filename().c_str(), motion->frame.size(),
                  motion->repairs.sentence(motion->frame.size()).c_str());
    }
  }
  EXPECT_GE(files, 6);
}

TEST(MotionFile, PlaysARealHandheldTrajectory) {
  const fs::path data = data_folder();
  if (data.empty()) {
    std::printf("shared data absent (set TACTUM_DATA): handheld trajectory not read\n");
    GTEST_SKIP() << "shared data absent";
  }
  Result<Motion> motion = read_motion((data / "trajectories" / "tum_fr1_xyz_handheld_100Hz.txt").string());
  ASSERT_TRUE(motion) << motion.error().message();
  EXPECT_NEAR(motion->time_s.back(), 30.0, 1.0);
  const Motion small = fitted(*motion, 0.1);
  double extent = 0.0;
  for (const Pose& X : small.X) extent = std::max(extent, X.p.norm());
  EXPECT_NEAR(extent, 0.1, 1e-12);
  EXPECT_LT(log_rotation(small.X.front().R).norm(), 1e-12);
  const RecordedMotion hand(small);
  for (double t = 0.0; t < hand.duration_s(); t += 0.0137) ASSERT_TRUE(hand.at(t).X_DH.finite());
}

TEST(RecordedMotion, PassesThroughItsRowsAndBetweenThem) {
  Motion motion;
  motion.time_s = {0.0, 0.5, 2.0};
  motion.X = {Pose{}, {exp_rotation({0, 0, 1}), {1, 0, 0}}, {exp_rotation({0, 0, 1}), {1, 3, 0}}};
  motion.buttons = {0, 1, 2};
  const RecordedMotion hand(motion);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LT((hand.at(motion.time_s[i]).X_DH.p - motion.X[i].p).norm(), 1e-15);
  }
  const HandState middle = hand.at(0.25);
  EXPECT_NEAR(middle.X_DH.p.x(), 0.5, 1e-15);
  EXPECT_NEAR(log_rotation(middle.X_DH.R).z(), 0.5, 1e-15);
  EXPECT_NEAR(middle.V_DH.v.x(), 2.0, 1e-14);
  EXPECT_NEAR(middle.V_DH.w.z(), 2.0, 1e-14);
  EXPECT_EQ(hand.at(0.6).buttons, 1u);
  EXPECT_EQ(hand.at(5.0).V_DH.v, Vec3(Vec3::Zero()));
}

TEST(NearestRotation, ProjectsNoiseAwayAndRefusesWhatIsNone) {
  Random random(41);
  const auto entry = [&random](double size) { return random.uniform(-size, size); };
  for (int i = 0; i < 2000; ++i) {
    const double x = entry(1.8);
    const double y = entry(1.8);
    const double z = entry(1.8);
    const Mat3 R = exp_rotation({x, y, z});
    // R times a symmetric stretch: the polar factor is R itself, whatever the stretch.
    Mat3 S;
    for (int k = 0; k < 9; ++k) S(k / 3, k % 3) = entry(0.2);
    const Mat3 stretch = Mat3::Identity() + 0.5 * (S + S.transpose());
    const NearestRotation nearest = orthonormalized(R * stretch);
    ASSERT_TRUE(nearest.exists) << "seed 41, try " << i;
    EXPECT_LT((nearest.R - R).cwiseAbs().maxCoeff(), 1e-14) << "seed 41, try " << i;
  }
  EXPECT_FALSE(orthonormalized(Mat3::Zero()).exists);
  EXPECT_FALSE(orthonormalized(-Mat3::Identity()).exists);
  EXPECT_FALSE(orthonormalized(Mat3::Constant(std::nan(""))).exists);
  EXPECT_FALSE(orthonormalized(Mat3::Ones()).exists);
}

}  // namespace
}  // namespace tactum
