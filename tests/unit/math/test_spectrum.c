/* Wavelengths as colours: white light is white, by every way to sum it. */
#include "tests/harness.h"

#include "math/spectrum.h"

#include <math.h>

static void check_white(struct colour sum, double tolerance) {
    CHECK_NEAR(sum.r, 1, tolerance);
    CHECK_NEAR(sum.g, 1, tolerance);
    CHECK_NEAR(sum.b, 1, tolerance);
}

TEST(the_mean_over_wavelengths_is_neutral) {
    enum { STEPS = 6400 };
    struct colour integral = {0, 0, 0}, samples = {0, 0, 0}, nodes = {0, 0, 0};
    for (int i = 0; i < STEPS; i++) {
        struct colour weight;
        double wavelength = SPECTRUM_MIN + (i + 0.5) * (SPECTRUM_MAX - SPECTRUM_MIN) / STEPS;
        integral = colour_add_scaled(integral, spectrum_colour(wavelength), (SPECTRUM_MAX - SPECTRUM_MIN) / STEPS);
        wavelength = spectrum_sample((i + 0.5) / STEPS, &weight);
        CHECK(wavelength >= SPECTRUM_MIN && wavelength <= SPECTRUM_MAX);
        CHECK_NEAR(spectrum_weight(wavelength).g, weight.g, 1e-9);
        samples = colour_add_scaled(samples, weight, 1.0 / STEPS);
    }
    for (int i = 0; i < SPECTRUM_NODES; i++)
        nodes = colour_add(nodes, spectrum_node_weight(i));
    check_white(integral, 1e-4);
    check_white(samples, 1e-3);
    check_white(nodes, 1e-9);
}

TEST(the_nodes_of_means_have_the_colours_of_their_wavelengths) {
    double step = spectrum_node(1) - spectrum_node(0);
    for (int i = 0; i < SPECTRUM_NODES; i++) {
        double wavelength = 1 / spectrum_node(i);
        struct colour colour = colour_scale(spectrum_colour(wavelength), step * wavelength * wavelength);
        CHECK_NEAR(spectrum_node_weight(i).r, colour.r, 1e-4);
        CHECK_NEAR(spectrum_node_weight(i).b, colour.b, 1e-4);
    }
}

/* The sRGB primaries do not reach single wavelengths: red light is free of blue, and none of green is without a
 * negative component. No sample weighs more than a few times the mean. */
TEST(single_wavelengths_have_the_hues_of_the_rainbow_and_negative_components) {
    struct colour red = spectrum_colour(0.65), green = spectrum_colour(0.52), blue = spectrum_colour(0.45), weight;
    CHECK(red.r > 5 * fabs(red.g) && red.r > 5 * fabs(red.b));
    CHECK(green.g > 0 && green.r < 0 && green.g > 3 * green.b);
    CHECK(blue.b > 5 * fabs(blue.r) && blue.g < 0);
    for (int i = 0; i < 1000; i++) {
        (void)spectrum_sample(i / 1000.0, &weight);
        CHECK(colour_max_abs(weight) < 10);
    }
}

/* The mean is 1 at 2,000 K by definition; red light leads there, and white is near 6,000 K. */
TEST(black_bodies_are_red_then_white_then_blue_and_brighter_when_hotter) {
    struct colour red = spectrum_black_body(2000), white = spectrum_black_body(5800), blue = spectrum_black_body(15000);
    CHECK_NEAR((red.r + red.g + red.b) / 3, 1, 1e-9);
    CHECK(red.r > 2 * red.g && red.g > 2 * red.b);
    CHECK_NEAR(white.r / white.g, 1, 0.15);
    CHECK_NEAR(white.b / white.g, 1, 0.15);
    CHECK(blue.b > 1.5 * blue.r);
    CHECK(white.g > 100 && blue.g > white.g);
    CHECK(colour_is_black(spectrum_black_body(1e-3)));
}
