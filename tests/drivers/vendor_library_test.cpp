#include "tactum/drivers/vendor_library.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "support/standin_files.h"

namespace tactum::vendor_library_test {

constexpr const char* kVariable = "TACTUM_TEST_LIBRARY";

/// The C library's mathematics, which is on every system that runs the tests.
LibrarySearch search_for(const std::vector<std::string>& names) {
  return {"Acme", kVariable, names, {"", "/nowhere/at/all"}, "install the Acme kit"};
}

bool says(const Error& error, const std::string& words) {
  return error.message().find(words) != std::string::npos;
}

/// A folder of its own, gone with the object; the variable is unset as well.
struct Folder {
  Folder() { std::filesystem::create_directory(path); }
  ~Folder() {
    unsetenv(kVariable);
    std::filesystem::remove_all(path);
  }
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "tactum_vendor_library";
};

TEST(VendorLibrary, FindsFunctions) {
  Result<VendorLibrary> library = VendorLibrary::load(search_for({"libm.so.6"}));
  ASSERT_TRUE(library) << library.error().message();
  double (*cosine)(double) = nullptr;
  library->require("cos", cosine);
  ASSERT_NE(cosine, nullptr);
  EXPECT_EQ(cosine(0.0), 1.0);
  EXPECT_TRUE(library->check());
}

TEST(VendorLibrary, NamesAllFunctionsThatAreLacking) {
  Result<VendorLibrary> library = VendorLibrary::load(search_for({"libm.so.6"}));
  ASSERT_TRUE(library);
  void (*absent)() = nullptr;
  library->require("acmeOpen", absent);
  library->require("acmeClose", absent);
  void (*optional)() = nullptr;
  EXPECT_FALSE(library->find("acmeBlink", optional));
  const Result<void> checked = library->check();
  ASSERT_FALSE(checked);
  EXPECT_TRUE(says(checked.error(), "acmeOpen, acmeClose")) << checked.error().message();
  EXPECT_TRUE(says(checked.error(), "a newer version: install the Acme kit"));
  EXPECT_TRUE(says(checked.error(), "libm.so.6")) << "which file it was";
  EXPECT_FALSE(says(checked.error(), "acmeBlink"));
}

TEST(VendorLibrary, ACompanionGivesWhatALibraryDoesNotSayThatItNeeds) {
  LibrarySearch search = search_for({standin_file("standin_needy")});
  const Result<VendorLibrary> alone = VendorLibrary::load(search);
  ASSERT_FALSE(alone);
  EXPECT_TRUE(says(alone.error(), "standin_companion_answer")) << alone.error().message();
  search.companions = {"libnowhere.so.9", standin_file("standin_companion")};
  const Result<VendorLibrary> library = VendorLibrary::load(search);
  ASSERT_TRUE(library) << library.error().message();
  int (*ask)() = nullptr;
  ASSERT_TRUE(library->find("standin_needy_ask", ask));
  EXPECT_EQ(ask(), 42);
}

TEST(VendorLibrary, TellsWhereAMissingOneWasLookedFor) {
  const Result<VendorLibrary> library = VendorLibrary::load(search_for({"libacme.so", "libacmeold.so"}));
  ASSERT_FALSE(library);
  for (const char* words : {"libacme.so or libacmeold.so", "/nowhere/at/all", "the loader's path",
                            "install the Acme kit", kVariable})
    EXPECT_TRUE(says(library.error(), words)) << library.error().message();
}

TEST(VendorLibrary, TheVariableNamesAFileOrAFolderAndNothingElseIsTried) {
  const Folder folder;
  setenv(kVariable, folder.path.c_str(), 1);
  Result<VendorLibrary> library = VendorLibrary::load(search_for({"libm.so.6"}));
  ASSERT_FALSE(library) << "the folder is empty, and the loader's path is not asked";
  EXPECT_TRUE(says(library.error(), folder.path.string()));
  setenv(kVariable, "libm.so.6", 1);
  EXPECT_TRUE(VendorLibrary::load(search_for({"libacme.so"})));
}

TEST(VendorLibrary, TheLoadersWordsAreTold) {
  const Folder folder;
  std::ofstream(folder.path / "libacme.so.2.1") << "not a library at all";
  setenv(kVariable, folder.path.c_str(), 1);
  const Result<VendorLibrary> library = VendorLibrary::load(search_for({"libacme.so"}));
  ASSERT_FALSE(library);
  EXPECT_TRUE(says(library.error(), "does not load")) << library.error().message();
  EXPECT_TRUE(says(library.error(), "libacme.so.2.1")) << "the version behind the name was found";
}

TEST(VendorLibrary, AMovedOneIsUnloadedOnce) {
  Result<VendorLibrary> library = VendorLibrary::load(search_for({"libm.so.6"}));
  ASSERT_TRUE(library);
  VendorLibrary moved = std::move(*library);
  EXPECT_TRUE(moved.loaded());
  EXPECT_FALSE(library->loaded());
  moved.unload();
  moved.unload();
  EXPECT_FALSE(moved.loaded());
}

}  // namespace tactum::vendor_library_test
