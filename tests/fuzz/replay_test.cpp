// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The kept corpus, in the ordinary tests: what was found once stays found. Each input also cut short and with flipped
// octets.
#include "common/source_tree.hpp"
#include "targets.hpp"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <memory>
#include <random>
#include <vector>

namespace gridspace::fuzz {

static void PrintTo(Target const& target, std::ostream* out) {
    *out << target.name;
}

namespace {

class Corpus : public testing::TestWithParam<Target> {};
INSTANTIATE_TEST_SUITE_P(Of, Corpus, testing::ValuesIn(kTargets), [](auto const& p) { return p.param.name; });

TEST_P(Corpus, IsSurvivedWholeCutShortAndDamaged) {
    std::filesystem::path const folder = std::filesystem::path{source_tree("tests/fuzz/corpus")} / GetParam().name;
    std::size_t files = 0;
    std::mt19937 random{1};
    for (auto const& entry : std::filesystem::directory_iterator{folder}) {
        std::ifstream in{entry.path(), std::ios::binary};
        std::vector<char> const content{std::istreambuf_iterator<char>{in}, {}};
        auto const run = [&](std::vector<char> const& octets) {
            auto const exact =
                std::make_unique<std::uint8_t[]>(octets.size()); // so that AddressSanitizer sees one octet too far
            std::copy(octets.begin(), octets.end(), exact.get());
            GetParam().run(exact.get(), octets.size());
        };
        run(content);
        for (int i = 0; i < 20 && !content.empty(); ++i) {
            auto changed = content;
            changed[random() % changed.size()] = static_cast<char>(random());
            run(changed);
            changed.resize(random() % content.size());
            run(changed);
        }
        ++files;
    }
    EXPECT_GT(files, 0U) << "an empty corpus tests nothing";
}

} // namespace
} // namespace gridspace::fuzz
