// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/app/foxglove.hpp"

#include <cstring>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace gridspace::monitor {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

/// Keeps what it is given to push.
class Pushes final : public web::Server {
  public:
    void push(web::ClientId, web::Message message) override {
        (message.binary ? binary : text).push_back(*message.octets);
    }
    [[nodiscard]] std::uint64_t dropped(web::ClientId) const override { return 0; }
    [[nodiscard]] web::Waiting waiting(web::ClientId) const override { return {}; }
    [[nodiscard]] web::ServerCounters counters() const override { return {}; }
    std::vector<json> take() {
        std::vector<json> out;
        for (std::string const& t : std::exchange(text, {})) {
            out.push_back(json::parse(t));
        }
        return out;
    }
    std::vector<std::string> text, binary;
};

class Foxglove : public testing::Test {
  protected:
    Foxglove() { run_.idl["Thing"] = "@final struct Thing { octet x; };"; }
    void sample(char content, std::int64_t time_ns) {
        std::byte const cdr[]{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}, static_cast<std::byte>(content)};
        run_.on_sample("data", "things", "Thing", "somebody", cdr, time_ns);
    }
    /// A client that has been greeted and told of the channel 1.
    void open() {
        sample('a', 5);
        sut_.opened(7);
        sut_.step(pushes_);
        pushes_.text.clear();
        pushes_.binary.clear();
    }
    std::vector<std::string> step() {
        sut_.step(pushes_);
        return std::exchange(pushes_.binary, {});
    }
    static std::string message(std::uint32_t subscription, std::uint64_t time_ns, char content) {
        std::string out(1, '\x01');
        out.append(reinterpret_cast<char const*>(&subscription), 4);
        out.append(reinterpret_cast<char const*>(&time_ns), 8);
        return out + std::string{'\0', '\1', '\0', '\0', content};
    }

    LiveRun run_{RunPlan{}};
    FoxgloveHub sut_{run_};
    Pushes pushes_;
};

TEST_F(Foxglove, IsSpokenOnlyWhenItIsOffered) {
    EXPECT_EQ(FoxgloveHub::choose({"x", "foxglove.websocket.v1"}), "foxglove.websocket.v1");
    EXPECT_FALSE(FoxgloveHub::choose({"x"}));
    EXPECT_FALSE(FoxgloveHub::choose({}));
}

TEST_F(Foxglove, GreetsAndAdvertisesEveryTopicWithTheIdlOfItsType) {
    sample('a', 5);
    sut_.opened(7);
    sut_.step(pushes_);
    auto const said = pushes_.take();
    ASSERT_THAT(said, SizeIs(2));
    EXPECT_EQ(said[0]["op"], "serverInfo");
    EXPECT_EQ(said[1]["op"], "advertise");
    EXPECT_EQ(said[1]["channels"], json::parse(R"([{"id":1,"topic":"things","encoding":"cdr","schemaName":"Thing",
                               "schema":"@final struct Thing { octet x; };","schemaEncoding":"omgidl"}])"));
}

TEST_F(Foxglove, AdvertisesATopicThatAppearsLater) {
    open();
    std::byte const cdr[4]{};
    run_.idl["Other"] = "@final struct Other { octet x; };";
    run_.on_sample("data", "others", "Other", "somebody", cdr, 1);
    sut_.step(pushes_);
    auto const said = pushes_.take();
    ASSERT_THAT(said, SizeIs(1));
    EXPECT_EQ(said[0]["channels"][0]["id"], 2);
}

TEST_F(Foxglove, StampsWhatIsWrittenAtTheWallClockWithTheTimeOfTheRun) {
    open();
    std::byte const cdr[]{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}, std::byte{'x'}};
    run_.on_sample("management", "member_status", "Thing", "somebody", cdr, 1'700'000'000'000'000'000);
    sut_.step(pushes_);
    ASSERT_EQ(pushes_.take().at(0)["channels"][0]["topic"], "member_status");
    sample('b', 8);
    sut_.message(7, R"({"op":"subscribe","subscriptions":[{"id":9,"channelId":2}]})");
    EXPECT_THAT(step(), ElementsAre(message(9, 8, 'x')));
}

TEST_F(Foxglove, SaysOnceWhichTopicIsLeftOutForWantOfItsIdl) {
    open();
    run_.on_sample("data", "others", "Other", "somebody", {}, 1);
    for (int i = 0; i < 100; ++i) {
        sut_.step(pushes_);
    }
    auto const said = pushes_.take();
    ASSERT_THAT(said, SizeIs(1));
    EXPECT_EQ(said[0]["op"], "status");
    EXPECT_THAT(said[0]["message"].get<std::string>(), testing::HasSubstr("'others' is left out"));
    sut_.opened(8); // one that comes later is told too
    sut_.step(pushes_);
    EXPECT_EQ(pushes_.take().back()["op"], "status");
}

TEST_F(Foxglove, SendsTheNewestSampleFirstAndThenEveryOneOnce) {
    open();
    sample('b', 6);
    sut_.message(7, R"({"op":"subscribe","subscriptions":[{"id":9,"channelId":1}]})");
    EXPECT_THAT(step(), ElementsAre(message(9, 6, 'b')));
    EXPECT_THAT(step(), IsEmpty());
    sample('c', 7);
    sample('d', 8);
    EXPECT_THAT(step(), ElementsAre(message(9, 7, 'c'), message(9, 8, 'd')));
    sut_.message(7, R"({"op":"unsubscribe","subscriptionIds":[9]})");
    sample('e', 9);
    EXPECT_THAT(step(), IsEmpty());
}

TEST_F(Foxglove, SaysWhatItDoesNotUnderstandAndLivesOn) {
    open();
    for (char const* text : {"", "[]", "{}", R"({"op":"advertise"})", R"({"op":"subscribe","subscriptions":[3]})",
                             R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":99}]})",
                             R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})",
                             R"({"op":"subscribe","subscriptions":[{"id":99999999999,"channelId":1}]})"}) {
        sut_.message(7, text);
        sut_.step(pushes_);
        auto const said = pushes_.take();
        ASSERT_THAT(said, SizeIs(1)) << text;
        EXPECT_EQ(said[0]["op"], "status") << text;
    }
    sut_.message(7, R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1}]})");
    EXPECT_THAT(step(), SizeIs(1));
}

TEST_F(Foxglove, TellsTheSimulatedTimeWhenItHasChanged) {
    open();
    run_.clock.time_s = 1.5;
    auto const told = step();
    ASSERT_THAT(told, SizeIs(1));
    std::uint64_t ns = 0;
    std::memcpy(&ns, told[0].data() + 1, 8);
    EXPECT_EQ(told[0][0], '\x02');
    EXPECT_EQ(ns, 1'500'000'000);
    EXPECT_THAT(step(), IsEmpty());
}

TEST_F(Foxglove, TellsWhoWritesAndReadsWhenAskedTo) {
    open();
    run_.graph.participant_found("data", {"p1", {"writer", 0, ""}, {}});
    run_.graph.endpoint_found("data", {"w", "p1", "things", "Thing", true, false, {}});
    sut_.message(7, R"({"op":"subscribeConnectionGraph"})");
    sut_.step(pushes_);
    auto const said = pushes_.take();
    ASSERT_THAT(said, SizeIs(1));
    EXPECT_EQ(said[0]["publishedTopics"], json::parse(R"([{"name":"things","publisherIds":["writer"]}])"));
    sut_.step(pushes_);
    EXPECT_THAT(pushes_.take(), IsEmpty());
}

} // namespace
} // namespace gridspace::monitor
