// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/yaml.hpp"
#include "sdk/described_settings.hpp"

#include <gmock/gmock.h>

namespace gridspace::sdk {
namespace {

using config::Key;
using Kind = Key::Kind;

config::Node node_of(std::string_view yaml) {
    config::Diagnostics diagnostics;
    return *config::parse_yaml(yaml, config::make_source("test", yaml), diagnostics);
}

std::vector<Key> keys() {
    return {{.key = "period_s", .doc = "", .kind = Kind::fraction, .default_text = "1/4"},
            {.key = "p_kw", .doc = "", .kind = Kind::number},
            {.key = "name", .doc = "", .kind = Kind::text},
            {.key = "fast", .doc = "", .kind = Kind::flag, .default_text = "false"},
            {.key = "limits",
             .doc = "",
             .kind = Kind::object,
             .children = {{.key = "low", .doc = "", .kind = Kind::number, .default_text = "-1"}}},
            {.key = "evs",
             .doc = "",
             .kind = Kind::map,
             .children = {{.key = "hours", .doc = "", .kind = Kind::number, .default_text = "4"}}}};
}

TEST(DescribedSettings, AreJsonOfTheKindThatTheirKeysSay) {
    auto const sut =
        with_defaults(node_of("{p_kw: 1/8, name: 12, fast: true, evs: {EV1: {}, EV2: {hours: 6}}}"), keys());

    EXPECT_EQ(to_json(sut, keys()),
              R"({"p_kw":0.125,"name":"12","fast":true,"evs":{"EV1":{"hours":4},"EV2":{"hours":6}},)"
              R"("period_s":"1/4","limits":{"low":-1}})");
}

TEST(DescribedSettings, AreFoundByTheirPath) {
    auto const sut = with_defaults(node_of("{evs: {EV2: {hours: 6}}}"), keys());

    EXPECT_EQ(setting_at(sut, "evs.EV2.hours"), "6");
    EXPECT_EQ(setting_at(sut, "limits.low"), "-1");
    EXPECT_EQ(setting_at(sut, "p_kw"), std::nullopt);
    EXPECT_EQ(setting_at(sut, "limits"), std::nullopt) << "a map is no text";
}

TEST(DescribedSettings, FillPatternsWithTheirNames) {
    auto const settings = node_of("{ev: EV1, evs: {EV2: {}, EV3: {}}, list: [a, b]}");
    auto const sut = values_of(settings, "car");

    EXPECT_THAT(program::expand("agent.{process}.{ev|evs}.p", sut),
                testing::ElementsAre("agent.car.EV1.p", "agent.car.EV2.p", "agent.car.EV3.p"));
    EXPECT_THAT(sut("list"), testing::ElementsAre("a", "b"));
}

} // namespace
} // namespace gridspace::sdk
