// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <string>

namespace gridspace::ethernet {

/// Runs `ip ARGUMENTS` in the test's namespace; fails the test when that fails.
void ip(std::string const& arguments);

/// Sends probes until one arrives.
void wait_until_frames_pass(std::string const& from, std::string const& to);

/// A test with a network namespace of its own that holds the two ends of a cable, `left` and `right`, and `lo`, all up.
/// With GRIDSPACE_TEST_UID=65534 in the environment, root becomes that user first: the namespace then is one that any
/// user can make. Where the kernel does not allow it, the test is skipped.
class Veth : public testing::Test {
  protected:
    static void SetUpTestSuite();
    void SetUp() override;
    void TearDown() override;

  private:
    static std::string why_not;
};

} // namespace gridspace::ethernet
