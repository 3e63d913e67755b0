#include "offline/scene/fingerprint.hpp"

#include <doctest/doctest.h>

#include <string>

using namespace greenloop::offline;

TEST_CASE("the published fingerprints of FNV-1a") {
  CHECK(fingerprint("").hex() == "6c62272e07bb014262b821756295c58d");
  CHECK(fingerprint("a").hex() == "d228cb696f1a8caf78912b704e4a8964");
  CHECK(fingerprint("foobar").hex() == "343e1662793c64bf6f0d3597ba446f18");
}

TEST_CASE("a fingerprint continues over pieces") {
  CHECK(fingerprint("bar", fingerprint("foo")) == fingerprint("foobar"));
  CHECK(fingerprint("rab", fingerprint("foo")) != fingerprint("foobar"));
}

TEST_CASE("bytes of zero and above 127 count") {
  CHECK(fingerprint(std::string(1, '\0')) != fingerprint(""));
  CHECK(fingerprint("\xff") != fingerprint("\x7f"));
}
