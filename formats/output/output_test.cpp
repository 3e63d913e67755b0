#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

#include "formats/output/output_file.hpp"
#include "formats/output/output_paths.hpp"
#include "formats/output/printable.hpp"
#include "formats/testing/temporary_folder.hpp"

using namespace greenloop;

namespace {

std::string read(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::ptrdiff_t entries(const std::filesystem::path& folder) {
  return std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator());
}

/// Files of this process are at most so long while in scope.
class SizeLimit {
 public:
  explicit SizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~SizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    (void)std::signal(SIGXFSZ, handler_);
  }
  SizeLimit(const SizeLimit&) = delete;
  SizeLimit& operator=(const SizeLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};

}  // namespace

TEST_CASE("what a terminal would obey or could not show is escaped") {
  CHECK(printable("plain\ttext\n") == "plain\ttext\n");
  CHECK(printable("\x1b[31mred\r\x7f") == "\\x1b[31mred\\x0d\\x7f");
  CHECK(printable(std::string("a\0b", 3)) == "a\\x00b");
  CHECK(printable("b\xC3\xA4r \xE2\x82\xAC \xF0\x9F\x90\xBB") == "b\xC3\xA4r \xE2\x82\xAC \xF0\x9F\x90\xBB");
  CHECK(printable("\xC2\x9B") == "\\u009b");                                   // CSI
  CHECK(printable("b\xE4r") == "b\xEF\xBF\xBDr");                              // Latin-1
  CHECK(printable("\xC0\x8A") == "\xEF\xBF\xBD\xEF\xBF\xBD");                  // a newline, too long
  CHECK(printable("\xED\xA0\x80") == "\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD");  // half of a pair
  CHECK(printable("\xF0\x9F\x90") == "\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD");  // cut off
}

TEST_CASE("a file is replaced whole, with its permissions, and nothing else is left") {
  const TemporaryFolder folder("output_test");
  const auto file = folder.path() / "file";
  write_text_file(file, "old");
  CHECK(read(file) == "old");
  REQUIRE(chmod(file.c_str(), 0640) == 0);
  write_text_file(file, "new");
  CHECK(read(file) == "new");
  struct stat status {};
  REQUIRE(stat(file.c_str(), &status) == 0);
  CHECK((status.st_mode & 0777U) == 0640);
  CHECK(entries(folder.path()) == 1);
}

TEST_CASE("links are followed, also to what is not there yet") {
  const TemporaryFolder folder("output_test");
  std::filesystem::create_directories(folder.path() / "deep");
  const auto target = folder.path() / "deep" / "target", link = folder.path() / "link",
             second = folder.path() / "second";
  std::filesystem::create_symlink("deep/target", link);
  std::filesystem::create_symlink("link", second);
  for (const char* text : {"first", "then"}) {
    write_text_file(second, text);
    CHECK(read(target) == text);
    CHECK(std::filesystem::is_symlink(link));
    CHECK(std::filesystem::is_symlink(second));
  }
  CHECK(entries(target.parent_path()) == 1);
  std::filesystem::create_symlink("circle", folder.path() / "circle");
  CHECK_THROWS_WITH(write_text_file(folder.path() / "circle", "x"), doctest::Contains("circle: cannot be written"));
}

TEST_CASE("a pipe is written through") {
  const TemporaryFolder folder("output_test");
  const auto pipe = folder.path() / "pipe";
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  std::string received;
  std::thread reader([&] { received = read(pipe); });
  write_text_file(pipe, "through");
  reader.join();
  CHECK(received == "through");
  CHECK(std::filesystem::is_fifo(pipe));
}

TEST_CASE("a disk that is full is an error, whatever is written to it") {
  CHECK_THROWS_WITH(write_text_file("/dev/full", "x"),
                    doctest::Contains("/dev/full: cannot be written: No space left"));
}

TEST_CASE("what cannot be written whole leaves what was there, and nothing beside it") {
  const TemporaryFolder folder("output_test");
  const auto file = folder.path() / "file";
  write_text_file(file, "old");
  const std::string large(100000, 'x');
  {
    const SizeLimit limit(50000);
    CHECK_THROWS_WITH(write_text_file(file, large), doctest::Contains("cannot be written: File too large; raise"));
    CHECK_THROWS(write_text_file(folder.path() / "other", large));
  }
  CHECK(read(file) == "old");
  CHECK(entries(folder.path()) == 1);
  {
    OutputFile unfinished(file);
    unfinished.write(std::string_view("half"));
  }
  CHECK(read(file) == "old");
  CHECK(entries(folder.path()) == 1);
}

TEST_CASE("lines that come one by one are all there") {
  const TemporaryFolder folder("output_test");
  OutputFile file(folder.path() / "lines");
  std::string all;
  for (int i = 0; i < 300000; ++i) {
    const std::string line = std::to_string(i) + "\n";
    file.write(line);
    all += line;
  }
  file.close();
  CHECK(read(folder.path() / "lines") == all);
}

TEST_CASE("a file that came meanwhile is not replaced by a new one") {
  const TemporaryFolder folder("output_test");
  const auto file = folder.path() / "file";
  PendingFile pending(file);
  CHECK_FALSE(std::filesystem::exists(file));
  write_text_file(file, "another's");
  CHECK_FALSE(pending.publish_new());
  CHECK(read(file) == "another's");
}

TEST_CASE("outputs that are inputs, each other or cannot be made are refused by name") {
  const TemporaryFolder folder("output_test");
  const auto at = [&](const char* name) { return folder.path() / name; };
  write_text_file(at("mesh"), "mesh");
  std::filesystem::create_hard_link(at("mesh"), at("hard"));
  std::filesystem::create_symlink("mesh", at("soft"));
  std::filesystem::create_symlink("new", at("dangling"));
  std::filesystem::create_directory(at("folder"));
  const auto refused = [&](std::vector<NamedPath> outputs, const char* why) {
    CHECK_THROWS_WITH(require_writable({.inputs = {{"the mesh", at("mesh")}}, .outputs = std::move(outputs)}),
                      doctest::Contains(why));
  };
  for (const char* name : {"mesh", "hard", "soft", "folder/../mesh"}) {
    refused({{"the model", at(name)}}, "the model would be written over the mesh");
  }
  refused({{"the model", at("new")}, {"the store", at("dangling")}}, "the store would be written over the model");
  refused({{"the model", at("new")}, {"the store", at("folder") / ".." / "new"}}, "would be written over the model");
  refused({{"the model", at("folder")}}, "Is a directory");
  refused({{"the model", at("none") / "new"}}, "No such file or directory; make its folder");
  refused({{"the model", at("mesh") / "new"}}, "Not a directory");
  refused({{"the model", ""}}, "its name is empty");
  refused({{"the model", at(std::string(300, 'a').c_str())}}, "File name too long");
  std::filesystem::create_symlink("second", at("first"));
  std::filesystem::create_symlink("first", at("second"));
  refused({{"the model", at("first")}}, "Too many levels of symbolic links");
  CHECK_NOTHROW(require_writable({.inputs = {{"the mesh", at("mesh")}},
                                  .outputs = {{"the model", at("new")}, {"the store", at("folder") / "new"}}}));
  CHECK_NOTHROW(require_writable({.inputs = {}, .outputs = {{"the model", "/dev/null"}, {"the trace", "/dev/null"}}}));
  CHECK_NOTHROW(require_writable_folder(at("a") / "b" / "c"));
  CHECK_THROWS_WITH(require_writable_folder(at("mesh") / "b"), doctest::Contains("Not a directory"));
}
