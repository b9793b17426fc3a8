// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/merge.hpp"

#include "common/config/yaml.hpp"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>

namespace gridspace::config {
namespace {

Node tree(std::string_view text) {
    Diagnostics diagnostics;
    auto root = parse_yaml(text, make_source("t.yaml", text), diagnostics);
    EXPECT_TRUE(diagnostics.ok()) << diagnostics.render();
    return root.value_or(Node::map());
}

class Folder {
  public:
    Folder() : path_{std::filesystem::temp_directory_path() / ("gridspace_merge_" + std::to_string(::getpid()))} {
        std::filesystem::create_directories(path_);
    }
    ~Folder() { std::filesystem::remove_all(path_); }
    std::filesystem::path write(std::string const& name, std::string_view text) const {
        std::ofstream{path_ / name} << text;
        return path_ / name;
    }

  private:
    std::filesystem::path path_;
};

TEST(Merge, MapsMergeListsReplaceAndTildeRemoves) {
    Node base = tree("a: {x: 1, y: 2}\nlist: [1, 2]\ngone: {k: 1}\n");
    merge(base, tree("a: {y: 3, z: 4}\nlist: [9]\ngone: ~\n"));
    EXPECT_EQ(to_yaml(base), "a:\n  x: 1\n  y: 3\n  z: 4\nlist: [9]\n");
}

TEST(ApplySet, OverridesAtAPathAndMakesWhatIsMissing) {
    Node root = tree("clock: {speed: max}\n");
    Diagnostics diagnostics;
    apply_set(root, "clock.speed=60", 1, diagnostics);
    apply_set(root, "processes.ev1.requested_h=4.5", 2, diagnostics);
    apply_set(root, "record={samples: all}", 3, diagnostics);
    EXPECT_TRUE(diagnostics.ok());
    EXPECT_EQ(to_yaml(root),
              "clock:\n  speed: 60\nprocesses:\n  ev1:\n    requested_h: 4.5\nrecord:\n  samples: all\n");
    EXPECT_EQ(root.find("clock")->find("speed")->where.to_string(), "--set #1:1:13");
}

TEST(ApplySet, AnEmptyMapEmptiesWhatStandsThere) {
    Node root = tree("expect: {v: {always: x > 1}}\nclock: {speed: 1, mode: lockstep}\n");
    Diagnostics diagnostics;
    apply_set(root, "expect={}", 1, diagnostics);
    apply_set(root, "new.list={}", 2, diagnostics);
    apply_set(root, "clock={speed: 2}", 3, diagnostics);
    EXPECT_TRUE(diagnostics.ok());
    EXPECT_EQ(to_yaml(root), "clock:\n  speed: 2\n  mode: lockstep\nexpect: {}\nnew:\n  list: {}\n");
}

TEST(ApplySet, RefusesWhatIsNotAnAssignment) {
    Node root = tree("a: 1\n");
    Diagnostics diagnostics;
    apply_set(root, "nothing", 1, diagnostics);
    apply_set(root, "=1", 2, diagnostics);
    apply_set(root, "a..b=1", 3, diagnostics);
    EXPECT_EQ(diagnostics.errors(), 3);
}

TEST(Extends, TheNearerFileWinsAndKeepsItsPlace) {
    Folder const folder;
    folder.write("base.yaml", "a: {x: 1, y: 2}\n");
    folder.write("middle.yaml", "extends: base.yaml\na: {y: 3}\n");
    auto const top = folder.write("top.yaml", "extends: middle.yaml\nb: 5\n");
    Diagnostics diagnostics;
    auto const root = load_extended(top, diagnostics);
    ASSERT_TRUE(root && diagnostics.ok()) << diagnostics.render();
    EXPECT_EQ(to_yaml(*root), "a:\n  x: 1\n  y: 3\nb: 5\n");
    EXPECT_TRUE(root->find("a")->find("y")->where.source->name.ends_with("middle.yaml"));
}

TEST(Extends, ACircleAndAMissingFileAreErrors) {
    Folder const folder;
    folder.write("a.yaml", "extends: b.yaml\n");
    folder.write("b.yaml", "extends: a.yaml\n");
    auto const lost = folder.write("c.yaml", "extends: nowhere.yaml\n");
    Diagnostics diagnostics;
    EXPECT_FALSE(load_extended(folder.write("a.yaml", "extends: b.yaml\n"), diagnostics).has_value());
    EXPECT_FALSE(load_extended(lost, diagnostics).has_value());
    EXPECT_EQ(diagnostics.errors(), 2);
}

TEST(Like, InheritsWithinASectionInAnyOrder) {
    Node section = tree("s2: {like: s1, mac: b}\ns1: {mac: a, rate_hz: 4800}\ns3: {like: s2, rate_hz: 4000}\n");
    Diagnostics diagnostics;
    resolve_likes(section, diagnostics);
    EXPECT_TRUE(diagnostics.ok());
    EXPECT_EQ(section.find("s3")->find("mac")->text, "b");
    EXPECT_EQ(section.find("s3")->find("rate_hz")->text, "4000");
    EXPECT_EQ(section.find("s2")->find("rate_hz")->text, "4800");
    EXPECT_EQ(section.find("s2")->find("like"), nullptr);
}

TEST(Like, AKeyBesideItReplacesTheWholeValueInItsOwnOrder) {
    Node section = tree("s1: {data_set: {a: float32, b: float32}, vlan_id: 3}\n"
                        "s2: {like: s1, data_set: {h: int16, b: float64}, vlan_id: ~}\n");
    Diagnostics diagnostics;
    resolve_likes(section, diagnostics);
    Node const& own = *section.find("s2")->find("data_set");
    ASSERT_EQ(own.entries.size(), 2U);
    EXPECT_EQ(own.entries[0].key, "h");
    EXPECT_EQ(own.entries[1].value.text, "float64");
    EXPECT_EQ(section.find("s2")->find("vlan_id"), nullptr);
}

TEST(Like, ALongChainIsResolvedWithoutDepth) {
    Node section = Node::map();
    constexpr int kLast = 100'000;
    for (int i = 0; i < kLast; ++i) {
        section.entries.push_back({"s" + std::to_string(i), {}, tree("like: s" + std::to_string(i + 1) + "\n")});
    }
    section.entries.push_back({"s" + std::to_string(kLast), {}, tree("mac: a\n")});
    Diagnostics diagnostics;
    resolve_likes(section, diagnostics);
    EXPECT_TRUE(diagnostics.ok());
    EXPECT_EQ(section.entries.front().value.find("mac")->text, "a");
}

TEST(Like, StandsForNoMoreThanAFileMayHold) {
    Node section = Node::map(), large = Node::map();
    for (int i = 0; i < 1000; ++i) {
        large.entries.push_back({"k" + std::to_string(i), {}, Node::scalar("1")});
    }
    section.entries.push_back({"large", {}, std::move(large)});
    for (int i = 0; i < 1000; ++i) {
        section.entries.push_back({"s" + std::to_string(i), {}, tree("like: large\n")});
    }
    Diagnostics diagnostics;
    resolve_likes(section, diagnostics);
    EXPECT_EQ(diagnostics.errors(), 1);
    EXPECT_NE(diagnostics.render().find("'like' stands for more than 500000 values here"), std::string::npos);
}

TEST(Like, UnknownAndCircularAreErrors) {
    Node section = tree("a: {like: b}\nb: {like: a}\nc: {like: aa}\n");
    Diagnostics diagnostics;
    resolve_likes(section, diagnostics);
    EXPECT_EQ(diagnostics.errors(), 2);
}

} // namespace
} // namespace gridspace::config
