// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/app/push.hpp"

#include "bus/codec.hpp"

#include <cstring>
#include <deque>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <set>
#include <signals.h>

namespace gridspace::monitor {
namespace {

using nlohmann::json;
using testing::ElementsAre;

constexpr web::ClientId kClient = 1;

/// A server whose client takes what it is sent when it is told to.
class SlowServer final : public web::Server {
  public:
    void push(web::ClientId, web::Message message) override { queue.push_back(std::move(message)); }
    [[nodiscard]] std::uint64_t dropped(web::ClientId) const override { return lost; }
    [[nodiscard]] web::Waiting waiting(web::ClientId) const override {
        web::Waiting out{queue.size(), 0};
        for (web::Message const& message : queue) {
            out.octets += message.octets->size();
        }
        return out;
    }
    [[nodiscard]] web::ServerCounters counters() const override { return {}; }
    /// The series that waited.
    std::vector<std::string> take() {
        std::vector<std::string> out;
        for (web::Message const& message : std::exchange(queue, {})) {
            if (message.binary) {
                out.push_back(*message.octets);
            }
        }
        return out;
    }
    std::deque<web::Message> queue;
    std::uint64_t lost{0};
};

json header_of(std::string const& series) {
    std::uint32_t size = 0;
    std::memcpy(&size, series.data(), 4);
    return json::parse(series.substr(4, size));
}

class Push : public testing::Test {
  protected:
    Push() { sut_.opened(kClient); }
    void signals(std::size_t columns, std::size_t rows, double rate_hz = 10, std::string const& unit = "V") {
        SignalCatalog catalog;
        catalog.source("sim");
        catalog.group(unit.c_str());
        catalog.rate_hz(rate_hz);
        catalog.columns().resize(columns);
        for (std::size_t c = 0; c < columns; ++c) {
            catalog.columns()[c].name(fmt::format("x{}", c).c_str());
            catalog.columns()[c].unit(unit.c_str());
        }
        hear("signal_catalog", "SignalCatalog", catalog);
        for (std::size_t row = 0; row < rows; ++row) {
            SignalFrame frame;
            frame.source("sim");
            frame.group(unit.c_str());
            frame.times_ns({static_cast<std::int64_t>(row) * 1'000'000});
            frame.values(std::vector<double>(columns, static_cast<double>(row % 7)));
            hear("signals", "SignalFrame", frame);
        }
    }
    template <class T>
    void hear(std::string const& topic, std::string const& type, T const& sample) {
        bus::Codec const& codec = bus::codec_of<T>();
        std::vector<std::byte> cdr(codec.encoded_size(&sample));
        ASSERT_GT(codec.encode(&sample, cdr), 0U);
        run_.on_sample("management", topic, type, "sim", cdr, 0);
    }
    void view(std::string const& id, std::vector<std::string> const& names, double window_s = -1, int px = 100) {
        sut_.message(kClient,
                     json{{"op", "view"}, {"id", id}, {"names", names}, {"window_s", window_s}, {"px", px}}.dump());
    }
    bool step() {
        now_ += std::chrono::milliseconds{50};
        return sut_.step(server_, now_);
    }
    /// Headers of what comes until nothing more does.
    std::vector<json> all() {
        std::vector<json> out;
        for (int quiet = 0; quiet < 5; ++quiet) {
            bool const done = step();
            for (std::string const& series : server_.take()) {
                out.push_back(header_of(series));
            }
            quiet = done ? quiet : 0;
        }
        return out;
    }

    LiveRun run_{RunPlan{}};
    Api api_{run_, [] { return web::ServerCounters{}; }};
    PushHub sut_{run_, api_};
    SlowServer server_;
    std::chrono::steady_clock::time_point now_{std::chrono::hours{1}};
};

TEST_F(Push, AnswersAViewWithALongNameAndIgnoresOneThatIsTooLong) {
    signals(1, 3);
    std::string const a(62, 'a');
    view(a + "aé", {"x0"}); // 65 octets: cut after 64 it would be no UTF-8
    view(a + "é", {"x0"});
    auto const answers = all();
    ASSERT_EQ(answers.size(), 1U);
    EXPECT_EQ(answers[0]["id"], a + "é");
}

TEST_F(Push, DrawsSignalsOfSomebodyWhoWritesNoUtf8) {
    signals(1, 3, 10, "\xff");
    view("a", {"x0"});
    auto const answers = all();
    ASSERT_EQ(answers.size(), 1U);
    EXPECT_EQ(answers[0]["series"][0]["unit"], "\xEF\xBF\xBD");
}

TEST_F(Push, AnswersEveryViewOfAClientThatTakesThemThoughNotAllAtOnce) {
    signals(1, 3);
    for (int i = 0; i < 48; ++i) {
        view(fmt::format("v{}", i), {"x0"});
    }
    step();
    server_.take();
    step();
    EXPECT_LE(server_.take().size(), 12U);
    std::set<std::string> ids;
    for (int i = 0; i < 48; ++i) {
        view(fmt::format("v{}", i), {"x0"}); // asked again
    }
    for (json const& answer : all()) {
        ids.insert(answer["id"].get<std::string>());
    }
    EXPECT_EQ(ids.size(), 48U);
}

TEST_F(Push, DrawsNothingForAClientThatDoesNotTakeWhatItWasSent) {
    signals(64, 2000);
    std::vector<std::string> names;
    for (int i = 0; i < 64; ++i) {
        names.push_back(fmt::format("x{}", i));
    }
    for (int i = 0; i < 48; ++i) {
        view(fmt::format("v{}", i), names, -1, 4000);
    }
    for (int i = 0; i < 3; ++i) {
        step();
        server_.queue.clear(); // what is told once
    }
    for (int i = 0; i < 100; ++i) {
        signals(64, 0);
        step();
    }
    std::size_t octets = 0;
    for (std::string const& series : server_.take()) {
        octets += series.size();
    }
    EXPECT_LE(octets, 3U << 20U);
}

TEST_F(Push, AnswersAgainWhatTheClientHasLost) {
    signals(1, 3);
    view("a", {"x0"});
    EXPECT_EQ(all().size(), 1U);
    EXPECT_EQ(all().size(), 0U); // nothing new
    server_.lost = 1;
    EXPECT_EQ(all().size(), 1U);
}

TEST_F(Push, TellsAndHoldsTheStepsOfASignalToTheEndThatAllPicturesHave) {
    signals(1, 3, 0);
    run_.clock.time_s = 5;
    view("a", {"x0"});
    step();
    server_.take();
    step();
    auto const series = server_.take();
    ASSERT_EQ(series.size(), 1U);
    json const header = header_of(series[0]);
    EXPECT_EQ(header["t1"], 5);
    EXPECT_EQ(header["series"][0]["steps"], true);
    ASSERT_EQ(header["series"][0]["points"], 4);
    std::array<double, 8> numbers{};
    std::memcpy(numbers.data(), series[0].data() + series[0].size() - sizeof numbers, sizeof numbers);
    EXPECT_THAT(numbers, ElementsAre(0, 0.001, 0.002, 5, 0, 1, 2, 2));
}

} // namespace
} // namespace gridspace::monitor
