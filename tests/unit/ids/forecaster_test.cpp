// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/forecaster/forecaster.hpp"
#include "ids/forecaster/model_file.hpp"
#include "ids/forecaster/squash.hpp"

#include "common/random.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

namespace gridspace::ids {
namespace {

Model network(int window, int hidden, int channels = 1) {
    Random r{5};
    Model m;
    m.name = "test";
    m.kind = "mlp";
    m.window = window;
    m.channels = channels;
    m.rate_hz = 4800;
    m.frequency_hz = 60;
    m.scale_a = 18;
    auto layer = [&](int inputs, int outputs, Layer::Activation activation) {
        Layer out{inputs, outputs, activation, {}, {}};
        for (int k = 0; k < inputs * outputs; ++k) {
            out.weights.push_back(r.uniform(-0.5, 0.5));
        }
        for (int k = 0; k < outputs; ++k) {
            out.bias.push_back(r.uniform(-0.1, 0.1));
        }
        return out;
    };
    m.layers = {layer(window * channels, hidden, Layer::Activation::tanh),
                layer(hidden, channels, Layer::Activation::linear)};
    m.provenance = {{"seed", "5"}, {"note", "a \"test\""}};
    return m;
}

std::vector<double> sinusoid(int count, double peak, double frequency_hz = 60) {
    std::vector<double> out;
    for (int k = 0; k < count; ++k) {
        out.push_back(peak * std::cos(2 * 3.141592653589793 * frequency_hz / 4800 * k + 0.3));
    }
    return out;
}

TEST(Forecaster, ComputesTheNetworkAsWrittenOut) {
    Model const m = network(20, 10);
    std::vector<double> const x = sinusoid(20, 15);
    double expected = m.layers[1].bias[0];
    for (std::size_t h = 0; h < 10; ++h) {
        double sum = m.layers[0].bias[h];
        for (std::size_t i = 0; i < 20; ++i) {
            sum += m.layers[0].weights[h * 20 + i] * x[i] / 18;
        }
        expected += m.layers[1].weights[h] * std::tanh(sum);
    }
    Forecaster<double> sut{m};
    double next = 0;
    sut.forecast(x.data(), &next);
    EXPECT_NEAR(next, expected * 18, 1e-12);
}

TEST(Forecaster, FloatAgreesWithDouble) {
    for (auto const scale : {Model::Scale::fixed, Model::Scale::window_peak}) {
        Model m = network(20, 10, 3);
        m.scale = scale;
        Forecaster<double> exact{m};
        Forecaster<float> sut{m};
        std::vector<double> const x = sinusoid(60, 15);
        std::vector<float> const xf(x.begin(), x.end());
        double next[3];
        float nextf[3];
        exact.forecast(x.data(), next);
        sut.forecast(xf.data(), nextf);
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(nextf[c], next[c], 2e-5);
        }
    }
}

TEST(Forecaster, TheOscillatorIsExactForASinusoidOfNominalFrequency) {
    Forecaster<double> sut{oscillator(4800, 60)};
    std::vector<double> const x = sinusoid(3, 17.9), off = sinusoid(3, 17.9, 59);
    double next = 0;
    sut.forecast(x.data(), &next);
    EXPECT_NEAR(next, x[2], 1e-12);
    sut.forecast(off.data(), &next);
    EXPECT_GT(std::fabs(next - off[2]), 1e-4); // and is not for another
}

TEST(Forecaster, AScaleByThePeakMakesTheForecastScaleWithTheWindow) {
    Model m = network(20, 10);
    m.scale = Model::Scale::window_peak;
    m.scale_a = 0.1;
    Forecaster<double> sut{m};
    std::vector<double> const small = sinusoid(20, 2), large = sinusoid(20, 200);
    double a = 0, b = 0;
    sut.forecast(small.data(), &a);
    sut.forecast(large.data(), &b);
    EXPECT_NEAR(b, 100 * a, 1e-10);
}

template <class Real>
void expect_the_bits_of_one_phase_after_another(Model const& model) {
    Forecaster<Real> sut{model};
    Random r{11};
    auto const n = static_cast<std::size_t>(model.window);
    std::vector<Real> history(3 * n);
    for (Real& x : history) {
        x = static_cast<Real>(r.uniform(-40, 40));
    }
    std::array<Real, 3> together{}, alone{};
    sut.forecast_phases(history.data(), together.data());
    for (std::size_t p = 0; p < 3; p += static_cast<std::size_t>(model.channels)) {
        sut.forecast(history.data() + p * n, alone.data() + p);
    }
    EXPECT_EQ(std::memcmp(together.data(), alone.data(), sizeof together), 0) << model.window << " " << model.channels;
}

TEST(Forecaster, ThreePhasesTogetherHaveTheBitsOfEachByItself) {
    Model linear = network(20, 1);
    linear.layers = {linear.layers.front()};
    linear.layers.front().activation = Layer::Activation::linear;
    for (Model const& model : {linear, network(20, 10), network(7, 3), network(20, 4, 3)}) {
        expect_the_bits_of_one_phase_after_another<double>(model);
        expect_the_bits_of_one_phase_after_another<float>(model);
    }
}

TEST(ModelFile, ReadsBackToTheSameModelBitByBit) {
    Model const m = network(20, 10);
    auto const back = model_from_json(to_json(m), "m.json");
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(*back, m);
    EXPECT_EQ(model_hash(*back), model_hash(m));
}

TEST(ModelFile, TheHashIsTheDocumentedOne) {
    // sha256("window=2\nchannels=1\nrate_hz=4800\nfrequency_hz=60\nscale=fixed\nscale_a=1\nlayer=1x2 linear\n"
    //        + struct.pack('<3d', -1, 1.5, 0)), with Python's hashlib
    Model m = oscillator(4800, 60);
    m.layers[0].weights = {-1, 1.5};
    EXPECT_EQ(model_hash(m), "17a9853c94568fe5a59008be81c02b0a963f79add6c88f2da794188f6a1f623b");
}

TEST(ModelFile, EveryDamageIsAnErrorThatNamesTheField) {
    std::string const good = to_json(network(4, 2));
    auto error_of = [](std::string const& text) {
        auto const r = model_from_json(text, "m.json");
        EXPECT_FALSE(r);
        return r ? std::string{} : r.error().message;
    };
    auto replaced = [&](std::string const& from, std::string const& to) {
        std::string text = good;
        auto const at = text.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        return text.replace(at, from.size(), to);
    };
    EXPECT_NE(error_of("").find("m.json: not readable as JSON"), std::string::npos);
    EXPECT_NE(error_of("{}").find("not a forecaster"), std::string::npos);
    EXPECT_NE(error_of("[1]").find("not a forecaster"), std::string::npos);
    EXPECT_NE(error_of(replaced("\"gridspace_forecaster\": 1", "\"gridspace_forecaster\": 2")).find("version 2"),
              std::string::npos);
    EXPECT_NE(error_of(replaced("\"window\": 4", "\"window\": 5")).find("layer 1 takes 4 inputs, and 5 come"),
              std::string::npos);
    EXPECT_NE(error_of(replaced("\"window\": 4", "\"window\": \"4\"")).find("window: a whole number"),
              std::string::npos);
    EXPECT_NE(error_of(replaced("\"window\": 4", "\"window\": -4")).find("window"), std::string::npos);
    EXPECT_NE(error_of(replaced("\"tanh\"", "\"relu\"")).find("layers[0].activation: 'relu' is not known"),
              std::string::npos);
    EXPECT_NE(error_of(replaced("\"window\"", "\"windoww\"")).find("window: it is missing"), std::string::npos);
    EXPECT_NE(error_of(replaced("\"kind\"", "\"extra\": 1, \"kind\"")).find("extra: unknown field"), std::string::npos);
    EXPECT_NE(error_of(replaced("\"scale_a\": 18.0", "\"scale_a\": 0")).find("a scale of 0 A"), std::string::npos);
    EXPECT_NE(error_of(replaced("\"scale_a\": 18.0", "\"scale_a\": 1e999")).find("m.json"), std::string::npos);
    EXPECT_NE(error_of(replaced("\"scale_a\": 18.0", "\"scale_a\": 17.0")).find("hash"), std::string::npos);
    EXPECT_NE(error_of(replaced("\"outputs\": 2", "\"outputs\": 3")).find("layer 1 has 8 weights; 3 x 4 = 12 expected"),
              std::string::npos);
    for (std::size_t cut = 0; cut + 2 < good.size(); cut += 7) {
        EXPECT_FALSE(model_from_json(good.substr(0, cut), "m.json"));
    }
}

TEST(ModelFile, AMissingFileIsNamed) {
    auto const r = load_model("/nonexistent/model.json");
    ASSERT_FALSE(r);
    EXPECT_EQ(r.error().message, "/nonexistent/model.json: no such file");
    EXPECT_FALSE(save_model(oscillator(4800, 60), "/nonexistent/model.json"));
}

TEST(Model, RefusesNumbersThatAreNotFinite) {
    Model m = network(4, 2);
    EXPECT_TRUE(check(m));
    m.layers[1].bias[0] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(check(m));
}

TEST(Squash, TwoAtOnceHaveTheSameBitsAsOneByOne) {
    Random random{5};
    std::vector<double> values{0.0,
                               -0.0,
                               1e-300,
                               -1e-9,
                               19.999,
                               -19.999,
                               20,
                               -20,
                               30,
                               -1e300,
                               std::numeric_limits<double>::infinity(),
                               std::numeric_limits<double>::quiet_NaN()};
    for (int i = 0; i < 100'001; ++i) {
        values.push_back(random.normal() * (i % 3 == 0 ? 8 : 0.7));
    }
    std::vector<double> sut = values;
    squash(sut.data(), sut.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        double const expected = elementary::tanh(values[i]);
        EXPECT_EQ(std::memcmp(&sut[i], &expected, sizeof expected), 0) << values[i];
    }
}

} // namespace
} // namespace gridspace::ids
