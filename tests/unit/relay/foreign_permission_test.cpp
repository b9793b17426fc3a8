// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/foreign_permission.hpp"

#include <gtest/gtest.h>

namespace gridspace::relay {
namespace {

using Reason = ForeignPermission::Reason;

/// A pickup from sample 100 on; verdicts come `late` samples after their sample, those of `flagged_end` in
/// [flagged_from, flagged_until) are flags. The first sample that is permitted; -1: none up to 400.
struct Trial {
    int late{3};
    int flagged_end{-1};
    std::int64_t flagged_from{0}, flagged_until{0};
    bool heard{true};

    std::int64_t permitted_at(ForeignPermission& sut) const {
        for (std::int64_t i = 0; i < 400; ++i) {
            for (std::size_t end = 0; heard && i >= late && end < 2; ++end) {
                std::int64_t const judged = i - late;
                sut.verdict(end, judged,
                            static_cast<int>(end) == flagged_end && judged >= flagged_from && judged < flagged_until);
            }
            if (sut.step(i, i > 100)) {
                return i;
            }
        }
        return -1;
    }
};
ForeignPermissionParams const kParams{10, 40, 96, true, true};

TEST(ForeignPermission, WaitsForTheVerdictOnThePickupAndNoLonger) {
    for (int const late : {1, 3, 9}) {
        ForeignPermission sut{kParams};
        EXPECT_EQ((Trial{.late = late}.permitted_at(sut)), 100 + late);
        EXPECT_EQ(sut.reason(), Reason::genuine);
    }
}

TEST(ForeignPermission, WithoutAPickupNothingIsPermittedAndNothingIsSaid) {
    ForeignPermission sut{kParams};
    sut.verdict(0, 5, true);
    EXPECT_FALSE(sut.step(6, false));
    EXPECT_EQ(sut.reason(), Reason::none);
}

TEST(ForeignPermission, AFlagAtEitherEndWithholdsAsLongAsThePickupLasts) {
    for (int const end : {0, 1}) {
        ForeignPermissionParams params = kParams;
        params.trips_at_last = false;
        ForeignPermission sut{params};
        EXPECT_EQ((Trial{.flagged_end = end, .flagged_from = 98, .flagged_until = 99}.permitted_at(sut)), -1);
        EXPECT_EQ(sut.reason(), Reason::flagged);
    }
}

TEST(ForeignPermission, AFlaggedPickupTripsAtLastWhereThatIsAsked) {
    ForeignPermission sut{kParams};
    EXPECT_EQ((Trial{.flagged_end = 0, .flagged_from = 98, .flagged_until = 99}.permitted_at(sut)), 100 + 96);
    EXPECT_EQ(sut.reason(), Reason::timed_out);
}

TEST(ForeignPermission, AFlagOfLongAgoDoesNotCount) {
    ForeignPermission sut{kParams};
    EXPECT_EQ((Trial{.flagged_end = 0, .flagged_from = 40, .flagged_until = 60}.permitted_at(sut)), 103);
    ForeignPermission near{kParams};
    EXPECT_EQ((Trial{.flagged_end = 0, .flagged_from = 40, .flagged_until = 61}.permitted_at(near)), 196);
}

TEST(ForeignPermission, ADetectorThatSaysNothingCostsTheWaitOrTheTrip) {
    ForeignPermission sut{kParams};
    EXPECT_EQ((Trial{.heard = false}.permitted_at(sut)), 110);
    EXPECT_EQ(sut.reason(), Reason::unheard);
    ForeignPermissionParams params = kParams;
    params.trips_unheard = false;
    ForeignPermission strict{params};
    EXPECT_EQ((Trial{.heard = false}.permitted_at(strict)), -1);
}

TEST(ForeignPermission, AVerdictOnOneEndAloneIsNone) {
    ForeignPermission sut{kParams};
    for (std::int64_t i = 0; i < 108; ++i) {
        sut.verdict(0, i, false);
        EXPECT_FALSE(sut.step(i, i > 100)) << i;
    }
    EXPECT_EQ(sut.reason(), Reason::waiting);
}

} // namespace
} // namespace gridspace::relay
