// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Two routers with a TCP link between them, in a network namespace of the test's own.
#include "bench.hpp"
#include "common/unique_fd.hpp"
#include "tests/integration/veth/veth.hpp"

#include <arpa/inet.h>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <sys/socket.h>

namespace gridspace::router {
namespace {

/// Certificates of two sites of one authority, and of an impostor whom another one has signed.
std::filesystem::path certificates() {
    static std::filesystem::path const folder = [] {
        char name[] = "/tmp/gridspace-link-XXXXXX";
        std::filesystem::path const out = ::mkdtemp(name);
        std::string script = fmt::format("cd {} && exec >/dev/null 2>&1 && set -e\n", out.string());
        for (char const* authority : {"ca", "other_ca"}) {
            script += fmt::format("openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 3650 "
                                  "-subj /CN={0} -keyout {0}.key -out {0}.pem\n",
                                  authority);
        }
        for (auto const& [site, authority] : {std::pair{"site_a", "ca"}, {"site_b", "ca"}, {"impostor", "other_ca"}}) {
            script += fmt::format(
                "openssl req -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -subj /CN={0} -keyout {0}.key -out "
                "{0}.csr\n"
                "openssl x509 -req -days 3650 -in {0}.csr -CA {1}.pem -CAkey {1}.key -CAcreateserial -out {0}.pem\n",
                site, authority);
        }
        EXPECT_EQ(std::system(("bash -c '" + script + "'").c_str()), 0);
        return out;
    }();
    return folder;
}

std::string tls(std::string const& name, std::string const& authority = "ca") {
    std::string const folder = certificates().string() + "/";
    return fmt::format(", tls: {{certificate: {0}{1}.pem, private_key: {0}{1}.key, authority: {0}{2}.pem}}", folder,
                       name, authority);
}

class Link : public ethernet::Veth {
  protected:
    static std::string site(std::string const& name, int domain, std::string const& link) {
        return fmt::format("router: {}\nends: {{local: {{domain: {}, addresses: [127.0.0.1]}}, wan: {{{}}}}}\ntopics: "
                           "{{x: {{}}, y: {{}}}}\n",
                           name, domain, link);
    }
    static void hear(bus::RawWriter& writer, Program& reader, std::string const& topic) {
        std::size_t const before = reader.heard(topic);
        Signal pause;
        ASSERT_TRUE(pause.wait([&] {
            writer.write_cdr(sample(7), kStart);
            return reader.heard(topic) > before;
        })) << topic;
    }
};

TEST_F(Link, SamplesCrossItInBothDirections) {
    Program left{"left", 1}, right{"right", 2};
    RunningRouter a{site("site_a", 1, "listen: 7411" + tls("site_a"))},
        b{site("site_b", 2, "connect: '127.0.0.1:7411'" + tls("site_b"))};
    auto &x = left.writes("x"), &y = right.writes("y");
    left.reads("y");
    right.reads("x");
    hear(x, right, "x");
    hear(y, left, "y");
    EXPECT_TRUE(a.wait_for("connected wan site_b"));
    EXPECT_TRUE(b.wait_for("connected wan site_a"));
    b.stop();
    EXPECT_TRUE(a.wait_for("left wan site_b"));
}

TEST_F(Link, EitherSideMayStartFirstAndComeBack) {
    Program left{"left", 1}, right{"right", 2};
    auto &x = left.writes("x"), &y = right.writes("y");
    left.reads("y");
    right.reads("x");
    RunningRouter connecting{site("site_b", 2, "connect: '127.0.0.1:7411'" + tls("site_b"))}; // nobody listens yet
    constexpr std::size_t kRounds = 2; // each takes some periods of discovery: 2 to 5 s
    for (std::size_t round = 1; round <= kRounds; ++round) {
        RunningRouter listening{site("site_a", 1, "listen: 7411" + tls("site_a"))};
        ASSERT_TRUE(connecting.wait_for("connected wan site_a", round)) << "round " << round;
        hear(x, right, "x");
        hear(y, left, "y");
    }
    EXPECT_TRUE(connecting.wait_for("left wan site_a", kRounds));
}

TEST_F(Link, TlsLetsInWhomTheAuthorityHasSignedAndNobodyElse) {
    Program left{"left", 1}, right{"right", 2}, stranger{"stranger", 3};
    RunningRouter a{site("site_a", 1, "listen: 7411" + tls("site_a"))};
    RunningRouter impostor{site("impostor", 3, "connect: '127.0.0.1:7411'" + tls("impostor"))};
    RunningRouter plain{site("plain", 3, "connect: '127.0.0.1:7411'")};
    auto& x = left.writes("x");
    right.reads("x");
    stranger.reads("x");
    RunningRouter b{site("site_b", 2, "connect: '127.0.0.1:7411'" + tls("site_b"))};
    ASSERT_TRUE(b.wait_for("connected wan site_a"));
    hear(x, right, "x");
    EXPECT_EQ(impostor.count("connected"), 0U);
    EXPECT_EQ(plain.count("connected"), 0U);
    EXPECT_EQ(a.count("connected wan impostor"), 0U);
    EXPECT_EQ(a.count("connected wan plain"), 0U);
    EXPECT_EQ(stranger.heard("x"), 0U);
    for (RunningRouter* one : {&a, &b, &impostor, &plain}) {
        one->note_silent_links();
        EXPECT_EQ(one->count("note wan: no router has answered at 127.0.0.1:7411"),
                  one == &impostor || one == &plain ? 1U : 0U);
    }
}

TEST_F(Link, APortThatSomebodyHasIsNamed) {
    UniqueFd const somebody{::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)};
    int const yes = 1; // connections of tests before may still be remembered
    ::setsockopt(somebody.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    sockaddr_in any{};
    any.sin_family = AF_INET;
    any.sin_port = htons(7411);
    ASSERT_EQ(::bind(somebody.get(), reinterpret_cast<sockaddr const*>(&any), sizeof any), 0);
    ASSERT_EQ(::listen(somebody.get(), 1), 0);
    try {
        RunningRouter sut{site("site_a", 1, "listen: 7411" + tls("site_a"))};
        FAIL() << "it started";
    } catch (std::runtime_error const& e) {
        EXPECT_NE(std::string{e.what()}.find("wan: cannot listen at port 7411"), std::string::npos) << e.what();
    }
}

TEST_F(Link, AHostOrAnAddressThatIsNotThereIsNamed) {
    for (auto const& [wan, expected] :
         {std::pair{"connect: 'nowhere.invalid:7411'", "cannot find the host 'nowhere.invalid'"},
          {"domain: 3, addresses: [10.255.1.2]", "no interface has the address 10.255.1.2"}}) {
        try {
            RunningRouter sut{site("site_a", 1, wan)};
            FAIL() << "it started";
        } catch (std::runtime_error const& e) {
            EXPECT_NE(std::string{e.what()}.find(expected), std::string::npos) << e.what();
        }
    }
}

TEST_F(Link, AMissingCertificateIsNamed) {
    try {
        RunningRouter sut{
            site("site_a", 1, "listen: 7411, tls: {certificate: /nowhere.pem, private_key: /k, authority: /a}")};
        FAIL() << "it started";
    } catch (std::runtime_error const& e) {
        EXPECT_NE(std::string{e.what()}.find("/nowhere.pem"), std::string::npos) << e.what();
    }
}

} // namespace
} // namespace gridspace::router
