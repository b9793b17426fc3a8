// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The server as a client sees it, over real sockets.
#include "monitor/web/server.hpp"

#include <arpa/inet.h>
#include <atomic>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <stdexcept>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <thread>

namespace gridspace::web {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr char const* kHost = "Host: localhost\r\n";
constexpr char const* kToken = "0123456789abcdef0123456789abcdef";

/// A server on a free port, and clients of it.
class ServerTest : public testing::Test {
  protected:
    void start(Limits limits = {}, std::vector<std::string> tokens = {}) {
        auto socket = listen_at("127.0.0.1:0");
        ASSERT_TRUE(socket.has_value());
        std::string const address = address_of(*socket);
        port_ = static_cast<std::uint16_t>(std::stoi(address.substr(address.rfind(':') + 1)));
        Handlers handlers;
        handlers.request = [](Request const& request) {
            if (request.target.path == "/fails") {
                throw std::runtime_error{"as it is asked to"};
            }
            Response response;
            response.content_type = "text/plain";
            response.body = request.method + " " + request.target.path + " " + request.body;
            return response;
        };
        handlers.accepts_push = [](std::string const& path,
                                   std::vector<std::string> const& offered) -> std::optional<std::string> {
            return !offered.empty()   ? std::optional{offered.back()}
                   : path == "/ws/v1" ? std::optional{std::string{}}
                                      : std::nullopt;
        };
        handlers.opened = [this](ClientId id, std::string const&, std::string const&) { client_ = id; };
        handlers.message = [](ClientId, std::string const& text) { throw std::runtime_error{text}; };
        handlers.closed = [this](ClientId) { ++closed_; };
        Server::Options options;
        options.limits = limits;
        options.tokens = std::move(tokens);
        auto server = Server::start(std::move(*socket), std::move(options), std::move(handlers));
        ASSERT_TRUE(server.has_value());
        sut_ = std::move(*server);
    }
    UniqueFd connect(int receive_buffer = 0) const {
        UniqueFd fd{::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)};
        if (receive_buffer > 0) {
            ::setsockopt(fd.get(), SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
        }
        timeval const patience{10, 0};
        ::setsockopt(fd.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(port_);
        ::inet_pton(AF_INET, "127.0.0.1", &address.sin_addr);
        EXPECT_EQ(::connect(fd.get(), reinterpret_cast<sockaddr const*>(&address), sizeof address), 0);
        return fd;
    }
    static void send(UniqueFd const& fd, std::string const& text) {
        [[maybe_unused]] auto const sent = ::send(fd.get(), text.data(), text.size(), MSG_NOSIGNAL);
    }
    /// Until the other end closes, or `until` has come.
    static std::string receive(UniqueFd const& fd, std::string const& until = {}) {
        std::string out;
        char buffer[4096];
        for (ssize_t n = 0; (n = ::recv(fd.get(), buffer, sizeof buffer, 0)) > 0;) {
            out.append(buffer, static_cast<std::size_t>(n));
            if (!until.empty() && out.find(until) != std::string::npos) {
                break;
            }
        }
        return out;
    }
    void push(std::string octets, bool lasting) const {
        sut_->push(client_, {std::make_shared<std::string const>(std::move(octets)), true, lasting});
    }
    std::string exchange(std::string const& request) const {
        UniqueFd const fd = connect();
        send(fd, request);
        return receive(fd);
    }
    UniqueFd open_push(int receive_buffer = 0) const {
        UniqueFd fd = connect(receive_buffer);
        send(fd, std::string{"GET /ws/v1 HTTP/1.1\r\n"} + kHost +
                     "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                     "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n");
        // The answer to this key is in RFC 6455, 1.3.
        EXPECT_THAT(receive(fd, "\r\n\r\n"), HasSubstr("s3pPLMBiTxaQ9kYGzzhZRbK+xOo="));
        while (client_ == 0) {
            std::this_thread::yield();
        }
        return fd;
    }

    /// A client that takes little, of a server that keeps four messages for it.
    UniqueFd open_slow_push() {
        Limits limits;
        limits.push_messages = 4;
        start(limits);
        return open_push(4096);
    }

    std::unique_ptr<Server> sut_;
    std::uint16_t port_{0};
    std::atomic<ClientId> client_{0};
    std::atomic<int> closed_{0};
};

TEST_F(ServerTest, AnswersAndKeepsTheConnection) {
    start();
    UniqueFd const fd = connect();
    send(fd, std::string{"GET /a HTTP/1.1\r\n"} + kHost + "\r\n");
    EXPECT_THAT(receive(fd, "GET /a "), StartsWith("HTTP/1.1 200"));
    send(fd, std::string{"POST /b HTTP/1.1\r\nContent-Length: 2\r\n"} + kHost + "\r\nhi");
    EXPECT_THAT(receive(fd, "POST /b hi"), StartsWith("HTTP/1.1 200"));
}

TEST_F(ServerTest, TellsBrowsersToLoadNothingFromElsewhere) {
    start();
    EXPECT_THAT(exchange(std::string{"GET / HTTP/1.0\r\n"} + kHost + "\r\n"),
                testing::AllOf(HasSubstr("Content-Security-Policy: default-src 'self'"),
                               HasSubstr("X-Content-Type-Options: nosniff")));
}

TEST_F(ServerTest, AnswersHeadWithoutABody) {
    start();
    std::string const answer = exchange(std::string{"HEAD /a HTTP/1.1\r\nConnection: close\r\n"} + kHost + "\r\n");
    EXPECT_THAT(answer, testing::AllOf(HasSubstr("Content-Length: 8"), testing::EndsWith("\r\n\r\n")));
}

struct BadRequest {
    char const* name;
    std::string text;
    char const* status;
};

class BadRequestTest : public ServerTest, public testing::WithParamInterface<BadRequest> {};

TEST_P(BadRequestTest, IsRefusedAndNobodyElseNotices) {
    start();
    EXPECT_THAT(exchange(GetParam().text), testing::AllOf(StartsWith(std::string{"HTTP/1.1 "} + GetParam().status),
                                                          HasSubstr("Content-Type: application/json"),
                                                          HasSubstr(R"({"error":")"), HasSubstr(R"(","remedy":")")));
    EXPECT_THAT(exchange(std::string{"GET /a HTTP/1.0\r\n"} + kHost + "\r\n"), HasSubstr("GET /a "));
}

INSTANTIATE_TEST_SUITE_P(
    Server, BadRequestTest,
    testing::Values(
        BadRequest{"NoHttp", "hello, is anybody there?\r\n\r\n", "400"},
        BadRequest{"StrangeHost", "GET / HTTP/1.1\r\nHost: evil.example\r\nConnection: close\r\n\r\n", "403"},
        BadRequest{"NoHost", "GET / HTTP/1.1\r\nConnection: close\r\n\r\n", "403"},
        BadRequest{"TwoHosts", "GET / HTTP/1.1\r\nHost: localhost\r\nHost: evil\r\nConnection: close\r\n\r\n", "403"},
        BadRequest{"StrangeOrigin",
                   "GET / HTTP/1.1\r\nHost: localhost\r\nOrigin: http://evil.example\r\nConnection: close\r\n\r\n",
                   "403"},
        BadRequest{"Climbing", "GET /../../etc/passwd HTTP/1.1\r\nHost: localhost\r\n\r\n", "400"},
        BadRequest{"EncodedClimbing", "GET /%2e%2e/%2e%2e/etc/passwd HTTP/1.1\r\nHost: localhost\r\n\r\n", "400"},
        BadRequest{"OtherMethod", "DELETE /a HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n", "405"},
        BadRequest{"HugeHeader", "GET / HTTP/1.1\r\nHost: localhost\r\nX: " + std::string(20000, 'a') + "\r\n\r\n",
                   "431"},
        BadRequest{"HugeBody", "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 10000000\r\n\r\n", "413"},
        BadRequest{"TwoLengths",
                   "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2\r\nContent-Length: 3\r\n\r\nabc", "400"},
        BadRequest{
            "LengthAndChunks",
            "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n",
            "400"},
        BadRequest{"PushElsewhere",
                   "GET /nowhere HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade, close\r\n"
                   "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n",
                   "404"}),
    [](auto const& parameter) { return parameter.param.name; });

TEST_F(ServerTest, LetsGoOfWhoeverWaitsLongestWhenThereAreTooManyConnections) {
    Limits limits;
    limits.connections = 2;
    start(limits);
    UniqueFd const first = connect(), second = connect();
    for (UniqueFd const* fd : {&first, &second}) {
        send(*fd, std::string{"GET /a HTTP/1.1\r\n"} + kHost + "\r\n");
        receive(*fd, "GET /a ");
    }
    EXPECT_THAT(exchange(std::string{"GET /a HTTP/1.0\r\n"} + kHost + "\r\n"), HasSubstr("GET /a "));
    EXPECT_EQ(receive(first), "");
    send(second, std::string{"GET /b HTTP/1.1\r\n"} + kHost + "\r\n");
    EXPECT_THAT(receive(second, "GET /b "), HasSubstr("GET /b "));
}

TEST_F(ServerTest, AnswersAThousandSocketsThatSayNothingByAnsweringOthers) {
    rlimit files{};
    ::getrlimit(RLIMIT_NOFILE, &files);
    files.rlim_cur =
        std::min<rlim_t>(std::max<rlim_t>(files.rlim_cur, 4096), files.rlim_max); // both ends are in this process
    ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &files), 0);
    start();
    std::vector<UniqueFd> idle;
    for (int i = 0; i < 1000; ++i) {
        idle.push_back(connect());
        if (i % 2 == 0) {
            send(idle.back(), "GET / HT");
        }
    }
    EXPECT_THAT(exchange(std::string{"GET /a HTTP/1.0\r\n"} + kHost + "\r\n"), HasSubstr("GET /a "));
    EXPECT_LE(sut_->counters().connections, Limits{}.connections + 1);
}

TEST_F(ServerTest, TellsWhoeverComesWhenAllConnectionsAreInUse) {
    Limits limits;
    limits.connections = 1;
    start(limits);
    UniqueFd const push = open_push();
    EXPECT_THAT(exchange(std::string{"GET /a HTTP/1.1\r\n"} + kHost + "\r\n"), StartsWith("HTTP/1.1 503"));
}

TEST_F(ServerTest, OpensNoMoreWebSocketsThanItMay) {
    Limits limits;
    limits.push_clients = 1;
    start(limits);
    UniqueFd const push = open_push();
    EXPECT_THAT(exchange(std::string{"GET /ws/v1 HTTP/1.1\r\n"} + kHost +
                         "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                         "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"),
                StartsWith("HTTP/1.1 503"));
    EXPECT_THAT(exchange(std::string{"GET /a HTTP/1.0\r\n"} + kHost + "\r\n"), HasSubstr("GET /a "));
}

TEST_F(ServerTest, AsksForTheTokenOnEveryRouteAndWebSocket) {
    start({}, {kToken});
    std::string const bearer = std::string{"Authorization: Bearer "} + kToken + "\r\n", close = "Connection: close\r\n";
    for (char const* path : {"/", "/a", "/api/v1/run", "/metrics", "/ws/v1"}) {
        std::string const line = std::string{"GET "} + path + " HTTP/1.1\r\n" + kHost + close;
        EXPECT_THAT(exchange(line + "\r\n"),
                    testing::AllOf(StartsWith("HTTP/1.1 401"), HasSubstr("WWW-Authenticate: Bearer")));
        EXPECT_THAT(exchange(line + bearer + "\r\n"), StartsWith("HTTP/1.1 200"));
    }
    std::string const upgrade = std::string{"GET /ws/v1 HTTP/1.1\r\n"} + kHost +
                                "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                                "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
    UniqueFd const without = connect(), with = connect();
    send(without, upgrade + "\r\n");
    EXPECT_THAT(receive(without, "\r\n\r\n"), StartsWith("HTTP/1.1 401"));
    send(with, upgrade + bearer + "\r\n");
    EXPECT_THAT(receive(with, "\r\n\r\n"), StartsWith("HTTP/1.1 101"));
    // In its address only a WebSocket may have it.
    EXPECT_THAT(exchange(std::string{"GET /a?token="} + kToken + " HTTP/1.1\r\n" + kHost + close + "\r\n"),
                StartsWith("HTTP/1.1 401"));
    for (auto const& [token, status] : {std::pair{kToken, "HTTP/1.1 101"}, {"wrong", "HTTP/1.1 401"}}) {
        std::string named = upgrade + "\r\n";
        named.replace(named.find("/ws/v1"), 6, std::string{"/ws/v1?token="} + token);
        UniqueFd const by_address = connect();
        send(by_address, named);
        EXPECT_THAT(receive(by_address, "\r\n\r\n"), StartsWith(status));
    }
}

TEST(Server, IsNotReachableFromOtherMachinesWithoutATokenAndTls) {
    for (auto const& tokens : {std::vector<std::string>{}, std::vector<std::string>{kToken}}) {
        auto socket = listen_at("0.0.0.0:0");
        ASSERT_TRUE(socket.has_value());
        Server::Options options;
        options.tokens = tokens;
        auto const server = Server::start(std::move(*socket), std::move(options), {});
        ASSERT_FALSE(server.has_value());
        EXPECT_THAT(server.error().message, HasSubstr("TLS"));
    }
}

TEST_F(ServerTest, DropsAClientThatNeverFinishesItsRequest) {
    Limits limits;
    limits.request_time = std::chrono::seconds{1};
    start(limits);
    UniqueFd const fd = connect();
    send(fd, "GET / HT");
    EXPECT_EQ(receive(fd), "");
}

TEST_F(ServerTest, ChoosesASubprotocolAmongThoseThatAreOffered) {
    start();
    UniqueFd const fd = connect();
    send(fd, std::string{"GET / HTTP/1.1\r\n"} + kHost +
                 "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                 "Sec-WebSocket-Protocol: something.else, foxglove.websocket.v1\r\n"
                 "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n");
    EXPECT_THAT(receive(fd, "\r\n\r\n"), HasSubstr("Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n"));
}

TEST_F(ServerTest, PushesToAWebSocket) {
    start();
    UniqueFd const fd = open_push();
    sut_->push(client_, {std::make_shared<std::string const>("hello")});
    EXPECT_EQ(receive(fd, "hello"), "\x81\x05hello"); // RFC 6455, 5.7
}

TEST_F(ServerTest, ServesOthersWhenOneRequestOrOneClientFails) {
    start();
    EXPECT_THAT(exchange(std::string{"GET /fails HTTP/1.0\r\n"} + kHost + "\r\n"), StartsWith("HTTP/1.1 500"));
    UniqueFd const fd = open_push();
    send(fd, std::string{"\x81\x82\x00\x00\x00\x00hi", 8}); // masked, as a client's must be
    EXPECT_EQ(receive(fd), "");                             // it is let go
    EXPECT_THAT(exchange(std::string{"GET /a HTTP/1.0\r\n"} + kHost + "\r\n"), HasSubstr("GET /a "));
}

TEST_F(ServerTest, KnowsWhatAClientHasNotTakenYet) {
    UniqueFd const fd = open_slow_push();
    Waiting waiting;
    while (sut_->counters().dropped < 150 ||
           waiting.messages == 0) { // the kernel takes some megabytes, sooner or later
        push(std::string(100'000, 'x'), false);
        waiting = sut_->waiting(client_);
    }
    EXPECT_EQ(waiting.octets, waiting.messages * 100'000);
    std::thread reader{[&fd] { receive(fd, "newest"); }};
    push("newest", false);
    while (sut_->waiting(client_).messages > 0) {
        std::this_thread::yield();
    }
    reader.join();
    EXPECT_EQ(sut_->waiting(client_).octets, 0U);
}

TEST_F(ServerTest, DropsTheOldestMessagesOfAClientThatDoesNotReadAndCountsThem) {
    UniqueFd const fd = open_slow_push();
    for (int i = 0; i < 200; ++i) {
        push(std::string(100'000, 'x') + (i == 199 ? "newest" : ""), false);
    }
    while (sut_->counters().dropped == 0) {
        std::this_thread::yield();
    }
    EXPECT_GT(sut_->dropped(client_), 0U);
    EXPECT_THAT(receive(fd, "newest"), HasSubstr("newest")); // it reads at last, and gets what is new
}

TEST_F(ServerTest, KeepsWhatNothingLaterSaysAgainForAClientThatDoesNotRead) {
    UniqueFd const fd = open_slow_push();
    for (int i = 0; i < 200; ++i) {
        push(i == 100 ? "the breaker is open" : std::string(100'000, 'x') + (i == 199 ? "newest" : ""), i == 100);
    }
    while (sut_->counters().dropped < 100) {
        std::this_thread::yield();
    }
    EXPECT_THAT(receive(fd, "newest"), HasSubstr("the breaker is open"));
}

TEST_F(ServerTest, LeavesAClientThatDoesNotReadWhatMustNotBeDropped) {
    Limits limits;
    limits.push_octets = 1'000'000;
    start(limits);
    UniqueFd const fd = open_push(4096);
    for (int i = 0; i < 200; ++i) {
        push(std::string(100'000, 'x'), true);
    }
    while (closed_ == 0) {
        std::this_thread::yield();
    }
    EXPECT_EQ(sut_->counters().push_clients, 0U);
}

TEST_F(ServerTest, NoticesAClientThatLeaves) {
    start();
    {
        UniqueFd const fd = open_push();
    }
    while (closed_ == 0) {
        std::this_thread::yield();
    }
    EXPECT_EQ(sut_->counters().push_clients, 0U);
}

TEST_F(ServerTest, EndsWhileClientsAreConnectedAndDoNotRead) {
    start();
    UniqueFd const idle = connect();
    UniqueFd const push = open_push(4096);
    for (int i = 0; i < 10; ++i) {
        this->push(std::string(1'000'000, 'x'), false);
    }
    sut_.reset();
    SUCCEED();
}

TEST(ListenAt, SaysWhatIsWrongWithAnAddress) {
    for (char const* bad : {"", "8080", "localhost:80", "127.0.0.1:x", "127.0.0.1:70000", "1.2.3:80"}) {
        EXPECT_FALSE(listen_at(bad).has_value()) << bad;
    }
}

} // namespace
} // namespace gridspace::web
