// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/ids/export/csv_file.hpp"
#include "launcher/ids/export/data_set.hpp"
#include "launcher/ids/export/frame_labels.hpp"
#include "launcher/ids/export/splits.hpp"

#include <gmock/gmock.h>
#include <map>
#include <set>

namespace gridspace::dataset {
namespace {

using Groups = std::vector<std::vector<std::string>>;

std::vector<std::string> ids(std::size_t count) {
    std::vector<std::string> out;
    for (std::size_t i = 0; i < count; ++i) {
        out.push_back("run" + std::to_string(i));
    }
    return out;
}

TEST(Splits, NoGroupIsInTwoPartsAndEachPartHasOne) {
    Groups const groups{{"a"}, {"b"}, {"c"}, {"a"}, {"d"}, {"e"}, {"b"}};
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
        auto const parts = split(groups, ids(groups.size()), seed);
        EXPECT_EQ(parts[0], parts[3]);
        EXPECT_EQ(parts[1], parts[6]);
        EXPECT_EQ(std::set<std::string>(parts.begin(), parts.end()).size(), 3U);
    }
}

TEST(Splits, KindsThatWereInOneRunAreInOnePart) {
    // a and b, b and c: then a and c must not be apart either, or the model was trained on what it is tested with.
    Groups const groups{{"a", "b"}, {"c"}, {"b", "c"}, {"d"}, {"e"}};
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
        auto const parts = split(groups, ids(groups.size()), seed);
        EXPECT_EQ(parts[0], parts[1]);
        EXPECT_EQ(parts[0], parts[2]);
    }
}

TEST(Splits, DependOnTheSeedAndOnNothingElse) {
    Groups const groups{{"a"}, {"b"}, {"c"}, {"d"}, {"e"}, {"f"}, {"g"}, {"h"}, {"i"}, {"j"}};
    auto const once = split(groups, ids(10), 1);
    EXPECT_EQ(once, split(groups, ids(10), 1));
    std::map<std::string, int> count;
    for (std::string const& part : once) {
        ++count[part];
    }
    EXPECT_EQ(count, (std::map<std::string, int>{{"train", 6}, {"validation", 2}, {"test", 2}}));
    bool differs = false;
    for (std::uint64_t seed = 2; seed < 10; ++seed) {
        differs = differs || split(groups, ids(10), seed) != once;
    }
    EXPECT_TRUE(differs);
    Groups const backwards{groups.rbegin(), groups.rend()};
    auto parts = split(backwards, ids(10), 1);
    EXPECT_EQ(std::vector<std::string>(parts.rbegin(), parts.rend()), once);
}

TEST(Splits, OfTwoGroupsAreTrainAndTestAndOfOneIsTrain) {
    EXPECT_THAT(split({{"a"}, {"b"}}, ids(2), 1), testing::UnorderedElementsAre("train", "test"));
    EXPECT_THAT(split({{"a"}, {"a"}}, ids(2), 1), testing::ElementsAre("train", "train"));
    EXPECT_TRUE(split({}, {}, 1).empty());
}

TEST(Splits, HealthyRunsTakeNoPartAwayFromTheKindsOfAttack) {
    std::vector<DataSetRun> runs(13);
    for (std::size_t i = 0; i < runs.size(); ++i) {
        runs[i].source.id = "run" + std::to_string(i);
        if (i < 3) {
            runs[i].source.labels.add("attack", "kind" + std::to_string(i), "S", {});
        }
    }
    assign_splits(runs, 1);
    EXPECT_EQ((std::set{runs[0].split_by_attack, runs[1].split_by_attack, runs[2].split_by_attack}).size(), 3U);
    EXPECT_EQ(runs[5].split_by_grid, runs[0].split_by_grid) << "all are of one grid";
}

TEST(LabelTable, FindsWhatWasAlteredOfASampleInWhateverOrderItCame) {
    LabelTable sut;
    sut.add("second", "bias", "S", {7, 0, 2, 1, 2});
    sut.add("first", "random", "S", {3, 0, 0, 1, 2});
    sut.add("second", "bias", "S", {7, 0, 1, 1, 2});
    sut.add("second", "bias", "T", {7, 0, 1, 1, 2});
    sut.sort();
    ASSERT_EQ(sut.of_sample("S", 7).size(), 2U);
    EXPECT_EQ(sut.of_sample("S", 7)[0].channel, 1);
    EXPECT_EQ(sut.attacks()[sut.of_sample("S", 3)[0].attack].name, "first");
    EXPECT_TRUE(sut.of_sample("S", 4).empty());
    EXPECT_TRUE(sut.of_sample("none", 7).empty());
}

TEST(FrameLabels, AForgedSampleAndTheGenuineOneBesideItAreToldApart) {
    RunSource run;
    run.labels.add("attack", "bias", "S", {3, 0, 1, 10.0, 12.0});
    run.labels.sort();
    FrameLabels const sut{run};
    EXPECT_TRUE(sut.of_sample("S", 3, {0, 12, 0}).altered());
    EXPECT_EQ(sut.of_sample("S", 3, {0, 12, 0}).phases, 2);
    EXPECT_FALSE(sut.of_sample("S", 3, {0, 10, 0}).altered());
    EXPECT_FALSE(sut.of_sample("S", 4, {0, 12, 0}).altered());
}

TEST(FrameLabels, AMessageThatLeavesTheCableOfAManInTheMiddleAsNoneHadComeIntoItIsAltered) {
    RunSource run;
    attacker::AttackConfig attack;
    attack.name.name = "stretch";
    attack.stream.name = "TRIP";
    attack.place = attacker::AttackConfig::Place::between;
    attack.between.resize(2);
    attack.between[0].name = "ied";
    attack.between[1].name = "bus";
    attack.until_s = Rational{1};
    attack.goose.emplace();
    run.attacks.push_back(attack);
    FrameLabels sut{run};
    ASSERT_TRUE(sut.has_to_learn());
    std::vector<std::uint8_t> genuine(60);
    genuine[12] = 0x88; // GOOSE
    genuine[13] = 0xB8;
    std::vector<std::uint8_t> altered = genuine;
    altered.back() = 1;
    sut.learn("bus/ied:evil", 0.5, genuine);
    sut.learn("bus/ied", 0.5, altered); // that is where it leaves
    EXPECT_FALSE(sut.of_message("TRIP", "bus/ied", 0.5, genuine).altered());
    EXPECT_TRUE(sut.of_message("TRIP", "bus/ied", 0.5, altered).altered());
    EXPECT_FALSE(sut.of_message("TRIP", "bus/ied", 1.5, altered).altered()) << "behind the attack";
    EXPECT_FALSE(sut.of_message("OTHER", "bus/ied", 0.5, altered).altered());
}

TEST(FrameLabels, FramesThatAreAlteredHeldBackOrCopiedOnTheWayAreToldFromThoseThatPass) {
    RunSource run;
    attacker::AttackConfig attack;
    attack.name.name = "frames";
    attack.stream.name = "SMV";
    attack.place = attacker::AttackConfig::Place::between;
    attack.between.resize(2);
    attack.between[0].name = "mu";
    attack.between[1].name = "bus";
    attack.until_s = Rational{2};
    attack.frames.emplace();
    run.attacks.push_back(attack);
    attack.name.name = "flood";
    attack.place = attacker::AttackConfig::Place::second_publisher;
    attack.by.name = "attacker";
    run.attacks.push_back(attack);
    run.host_of["attacker"] = "evil";
    FrameLabels sut{run};
    std::vector<std::uint8_t> genuine(60);
    genuine[12] = 0x88; // sampled values
    genuine[13] = 0xBA;
    std::vector<std::uint8_t> altered = genuine;
    altered.back() = 1;
    sut.learn("bus/mu:evil", 0.5, genuine);
    sut.learn("bus/mu:evil", 1.5, genuine); // the same again, a second later
    EXPECT_FALSE(sut.of_frame("SMV", "bus/mu", 0.5, genuine).altered());
    EXPECT_EQ(sut.of_frame("SMV", "bus/mu", 0.5001, genuine).attack, "frames") << "a copy";
    EXPECT_FALSE(sut.of_frame("SMV", "bus/mu", 1.5, genuine).altered());
    EXPECT_TRUE(sut.of_frame("SMV", "bus/mu", 0.6, altered).altered());
    EXPECT_FALSE(sut.of_frame("SMV", "bus/mu", 2.6, altered).altered()) << "behind the attack";
    EXPECT_FALSE(sut.of_frame("SMV", "bus/mu:evil", 0.6, altered).altered()) << "inside of the cable";
    EXPECT_FALSE(sut.of_frame("OTHER", "bus/mu", 0.6, altered).altered());
    EXPECT_EQ(sut.of_frame("SMV", "bus/evil", 0.6, genuine).attack, "flood");
    FrameLabels late{run};
    late.learn("bus/mu:evil", 0.5, genuine);
    EXPECT_TRUE(late.of_frame("SMV", "bus/mu", 0.503, genuine).altered()) << "held back for 3 ms";
}

TEST(CsvFile, TimesAreExactAndTextsKeepTheirCell) {
    EXPECT_EQ(seconds_text(-1), "-0.000000001");
    EXPECT_EQ(seconds_text(3'600'000'000'001), "3600.000000001");
    EXPECT_EQ(cell("a,\"b\""), "\"a,\"\"b\"\"\"");
    EXPECT_EQ(cell("plain"), "plain");
}

} // namespace
} // namespace gridspace::dataset
