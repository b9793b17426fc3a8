// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/lockstep/roster.hpp"

#include <gtest/gtest.h>

namespace gridspace::lockstep {
namespace {

using Standing = Roster::Standing;

struct Sut {
    Roster roster;
    std::vector<std::uint32_t> gone;
    Standing standing(std::string const& process, std::uint32_t incarnation, std::uint32_t participant) {
        return roster.standing({process, incarnation, participant},
                               [&](std::uint32_t p) { return std::find(gone.begin(), gone.end(), p) != gone.end(); });
    }
};

TEST(Roster, BeforeReadyEverybodyIsWhoHeSays) {
    Sut sut;
    EXPECT_EQ(sut.standing("ev1", 0, 1), Standing::member);
    EXPECT_EQ(sut.standing("ev1", 0, 2), Standing::member);
}

TEST(Roster, FromReadyOnNobodyElseIsObeyedUnderAName) {
    Sut sut;
    sut.roster.settle({{"ev1", 0, 1}, {"sim", 0, 2}, {"sim", 0, 3}});
    EXPECT_EQ(sut.standing("ev1", 0, 1), Standing::member);
    EXPECT_EQ(sut.standing("sim", 0, 3), Standing::member) << "a process may have two participants";
    EXPECT_EQ(sut.standing("ev1", 0, 4), Standing::impostor);
    EXPECT_EQ(sut.standing("ev1", 1, 4), Standing::impostor) << "nobody has restarted it";
    EXPECT_EQ(sut.standing("ev2", 0, 5), Standing::member) << "the first under its name";
    EXPECT_EQ(sut.standing("ev2", 0, 6), Standing::impostor);
}

TEST(Roster, ARestartedProcessTakesItsPlaceWhenTheSimulatorHoldsTheClockForIt) {
    Sut sut;
    sut.roster.settle({{"ev1", 0, 1}});
    sut.roster.expect_restarts();
    EXPECT_EQ(sut.standing("ev1", 1, 2), Standing::member);
    EXPECT_EQ(sut.standing("ev1", 0, 1), Standing::former);
    sut.roster.settle({{"ev1", 0, 1}, {"ev1", 1, 2}, {"ev1", 1, 3}});
    EXPECT_EQ(sut.standing("ev1", 1, 3), Standing::member);
    EXPECT_EQ(sut.standing("ev1", 2, 4), Standing::impostor);
}

TEST(Roster, ARestartedProcessIsKnownWithoutHavingBeenHeard) {
    Sut sut;
    sut.roster.settle({{"ev1", 0, 1}});
    sut.roster.expect_restarts();
    sut.roster.settle({{"ev1", 0, 1}, {"ev1", 1, 2}});
    EXPECT_EQ(sut.standing("ev1", 1, 2), Standing::member);
    EXPECT_EQ(sut.standing("ev1", 1, 9), Standing::impostor);
}

TEST(Roster, TheSimulatorExpectsOneRestartAndNoOther) {
    Sut sut;
    sut.roster.settle({{"ev1", 0, 1}, {"ev2", 0, 2}});
    sut.roster.expect_restart("ev1", 1);
    EXPECT_EQ(sut.standing("ev2", 1, 3), Standing::impostor);
    EXPECT_EQ(sut.standing("ev1", 2, 4), Standing::impostor);
    EXPECT_EQ(sut.standing("ev1", 1, 5), Standing::member);
}

TEST(Roster, AProcessThatJoinsLateTakesTheNewestIncarnation) {
    Sut sut;
    sut.roster.settle({{"ev1", 0, 1}, {"ev1", 1, 2}});
    EXPECT_EQ(sut.standing("ev1", 1, 2), Standing::member);
    EXPECT_EQ(sut.standing("ev1", 0, 1), Standing::former);
}

TEST(Roster, InRealTimeThePlaceOfWhoHasLeftIsFree) {
    Sut sut;
    sut.roster.settle({{"board", 0, 1}});
    EXPECT_EQ(sut.standing("board", 0, 2), Standing::impostor);
    sut.gone = {1};
    EXPECT_EQ(sut.standing("board", 0, 2), Standing::member);
    EXPECT_EQ(sut.standing("board", 0, 3), Standing::impostor);
}

} // namespace
} // namespace gridspace::lockstep
