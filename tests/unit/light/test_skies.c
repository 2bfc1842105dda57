/* Skies other than the cross: six pictures, a map of the sphere, colour stops, the clear sky and its sun. */
#include "image/image.h"
#include "light/sky.h"
#include "tests/harness.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static struct vec3 any_direction(struct test_random *random) {
    for (;;) {
        struct vec3 d;
        d.x = test_uniform(random, -1, 1), d.y = test_uniform(random, -1, 1), d.z = test_uniform(random, -1, 1);
        if (vec3_length(d) > 0.1 && vec3_length(d) < 1)
            return vec3_normalize(d);
    }
}

TEST(six_pictures_are_the_cross_they_were_cut_from) {
    enum { SIDE = 16 };
    static const int cells[6][2] = {{2, 1}, {0, 1}, {1, 2}, {1, 0}, {3, 1}, {1, 1}}; /* -x +x -y +y -z +z */
    uint8_t *cross = calloc(SIDE * SIDE * 12, 4), face[SIDE * SIDE * 4];
    struct test_random random = {3};
    for (int i = 0; i < SIDE * SIDE * 48; i++)
        cross[i] = (uint8_t)(i % 4 == 3 ? 255 : test_uniform(&random, 0, 256));
    struct error error = {0};
    struct image *images[6], *whole = image_create("cross", SIDE * 4, SIDE * 3, 8, cross, &error);
    for (int f = 0; f < 6; f++) {
        for (int y = 0; y < SIDE; y++)
            memcpy(face + y * SIDE * 4, cross + ((cells[f][1] * SIDE + y) * SIDE * 4 + cells[f][0] * SIDE) * 4,
                   SIDE * 4);
        images[f] = image_create("face", SIDE, SIDE, 8, face, &error);
    }
    struct sky of_cross, of_faces;
    CHECK(sky_from_cross(whole, false, &of_cross, &error) && sky_from_faces(images, &of_faces, &error));
    for (int i = 0; i < 2000; i++) {
        struct vec3 d = any_direction(&random);
        double spread = i % 2 ? 0.2 : 0;
        struct colour off = colour_sub(sky_colour(&of_cross, d, spread), sky_colour(&of_faces, d, spread));
        CHECK(colour_max_abs(off) == 0);
    }
    image_release(images[3]);
    images[3] = whole;
    CHECK(!sky_from_faces(images, &of_faces, &error));
    CHECK(strstr(error.text, "square") != NULL);
    for (int f = 0; f < 6; f++)
        image_release(images[f]);
    free(cross);
}

static struct image *map_image(void) {
    enum { W = 64, H = 32 };
    static uint8_t texels[W * H * 4];
    struct error error = {0};
    struct test_random random = {8};
    for (int i = 0; i < W * H * 4; i++)
        texels[i] = (uint8_t)(i % 4 == 3 ? 255 : test_uniform(&random, 0, 256));
    return image_create("map", W, H, 8, texels, &error);
}

static struct vec3 direction_at(double longitude, double latitude) {
    return vec3_make(cos(latitude) * sin(longitude), sin(latitude), -cos(latitude) * cos(longitude));
}

TEST(a_map_of_the_sphere_is_looked_up_by_longitude_and_latitude) {
    struct sky sky = {.kind = SKY_MAP, .image = map_image()};
    for (uint32_t y = 0; y < 32; y += 3) {
        for (uint32_t x = 0; x < 64; x += 5) {
            struct vec3 d = direction_at((x - 31.5) / 64 * 2 * pi, (15.5 - y) / 32 * pi);
            struct rgba texel = image_texel(sky.image, x, y);
            struct colour c = sky_colour(&sky, d, 0);
            CHECK_NEAR(c.r, texel.r, 1e-9);
            CHECK_NEAR(c.g, texel.g, 1e-9);
            CHECK_NEAR(c.b, texel.b, 1e-9);
        }
    }
    image_release(sky.image);
}

static void check_seams(struct image *image) {
    struct sky sky = {.kind = SKY_MAP, .image = image};
    struct test_random random = {11};
    const double step = 1e-7;
    for (int i = 0; i < 500; i++) {
        double spread = i % 2 ? 0.3 : 0, latitude = test_uniform(&random, -1.5, 1.5);
        struct colour a = sky_colour(&sky, direction_at(pi - step, latitude), spread);
        struct colour b = sky_colour(&sky, direction_at(-pi + step, latitude), spread);
        CHECK(colour_max_abs(colour_sub(a, b)) < 1e-4);
        double longitude = test_uniform(&random, -3, 3), pole = i % 4 < 2 ? pi / 2 : -pi / 2;
        a = sky_colour(&sky, direction_at(longitude, pole - step), spread);
        b = sky_colour(&sky, direction_at(longitude, pole + step), spread);
        CHECK(colour_max_abs(colour_sub(a, b)) < 1e-4);
    }
    image_release(sky.image);
}

TEST(a_map_of_the_sphere_has_no_seam_at_the_back_nor_at_the_poles) {
    check_seams(map_image());
    /* The width need not be even. */
    float texels[21 * 9 * 4];
    struct error error = {0};
    struct test_random random = {12};
    for (int i = 0; i < 21 * 9 * 4; i++)
        texels[i] = i % 4 == 3 ? 1 : (float)test_uniform(&random, 0, 2);
    check_seams(image_create("odd", 21, 9, 32, texels, &error));
}

TEST(a_sky_is_turned_counterclockwise_seen_from_above_and_made_brighter) {
    struct sky sky = {.kind = SKY_MAP, .image = map_image()}, turned = sky;
    turned.adjusted = true;
    turned.intensity = 3;
    turned.turn_sine = 1;
    turned.turn_cosine = 0;
    /* A quarter turn moves the picture at -z to -x. */
    struct colour a = sky_colour(&sky, vec3_make(0, 0.6, -0.8), 0), b = sky_colour(&turned, vec3_make(-0.8, 0.6, 0), 0);
    CHECK(colour_max_abs(colour_sub(colour_scale(a, 3), b)) < 1e-9);
    image_release(sky.image);
}

TEST(stops_are_met_and_linear_between) {
    static const double stops[][4] = {{-0.5, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}, {1, 1, 1, 1}};
    struct sky sky = {.kind = SKY_STOPS, .stops = stops, .stop_count = 4};
    static const double expected[][4] = {{-1, 1, 0, 0}, {-0.5, 1, 0, 0},    {-0.25, 0.5, 0.5, 0},
                                         {0, 0, 0, 1},  {0.5, 0.5, 0.5, 1}, {1, 1, 1, 1}};
    for (int i = 0; i < 6; i++) {
        double y = expected[i][0];
        struct colour c = sky_colour(&sky, vec3_make(sqrt(1 - y * y), y, 0), 0);
        CHECK_NEAR(c.r, expected[i][1], 1e-12);
        CHECK_NEAR(c.g, expected[i][2], 1e-12);
        CHECK_NEAR(c.b, expected[i][3], 1e-12);
    }
}

static double luminance(struct colour c) {
    return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b;
}

TEST(the_clear_sky_has_the_zenith_luminance_and_symmetry_of_its_model) {
    for (int i = 0; i < 4; i++) {
        double theta = 0.3 + 0.25 * i, turbidity = 2 + i;
        struct sky sky;
        sky_make_clear(vec3_make(sin(theta), cos(theta), 0), turbidity, colour_all(0.1), &sky);
        double chi = (4.0 / 9 - turbidity / 120) * (pi - 2 * theta);
        double zenith = (4.0453 * turbidity - 4.9710) * tan(chi) - 0.2155 * turbidity + 2.4192;
        CHECK_NEAR(luminance(sky_colour(&sky, vec3_make(0, 1, 0), 0)), zenith / 20, 2e-3 * zenith);
        struct test_random random = {21};
        for (int k = 0; k < 100; k++) {
            struct vec3 d = any_direction(&random), mirrored = {d.x, d.y, -d.z};
            CHECK(colour_max_abs(colour_sub(sky_colour(&sky, d, 0), sky_colour(&sky, mirrored, 0))) < 1e-12);
            CHECK(luminance(sky_colour(&sky, d, 0)) <= luminance(sky_colour(&sky, sky.clear.sun, 0)) * 1.3 + 1e-9 ||
                  d.y < 0.1); /* bright around the sun and at the horizon */
        }
        struct colour away = sky_colour(&sky, vec3_make(-sin(0.8), cos(0.8), 0), 0);
        CHECK(away.b > away.g && away.g > away.r); /* blue */
        CHECK(sky_colour(&sky, vec3_make(0.6, -0.8, 0), 0).r == 0.1);
    }
}

static struct vec3 sun_at(int year, double day, double hour, double latitude, double longitude, double zone) {
    return sky_sun(&(struct sky_time){.year = year, .day = day, .hour = hour, .zone = zone}, latitude, longitude);
}

TEST(the_sun_has_the_direction_of_the_almanac) {
    /* Altitude at true noon is 90 - latitude + declination; 23.4 degrees on 21 June, 0 at the equinoxes. */
    struct vec3 june = sun_at(2025, 172, 12, 51.5, 0, 0), december = sun_at(2025, 355, 12, 51.5, 0, 0);
    CHECK_NEAR(asin(june.y) * 180 / pi, 90 - 51.5 + 23.4, 0.5);
    CHECK_NEAR(asin(december.y) * 180 / pi, 90 - 51.5 - 23.4, 0.5);
    CHECK(june.z > 0.4); /* in the south */
    struct vec3 morning = sun_at(2025, 80, 6, 0, 0, 0), equator = sun_at(2025, 80, 12, 0, 0, 0);
    CHECK(morning.x > 0.99 && fabs(morning.y) < 0.05); /* rises in the east */
    CHECK(equator.y > 0.998);
    /* An hour of clock time is fifteen degrees of longitude; a time zone compensates them. */
    struct vec3 a = sun_at(2025, 172, 9, 40, 15, 0), b = sun_at(2025, 172, 10, 40, 0, 0),
                c = sun_at(2025, 172, 11, 40, 15, 2);
    CHECK(vec3_max_abs(vec3_sub(a, b)) < 1e-4); /* in an hour, the sun moves among the stars, too */
    CHECK(vec3_max_abs(vec3_sub(a, c)) < 1e-12);
    CHECK_NEAR(vec3_length(a), 1, 1e-14);
}

/* The Solar Calculator of NOAA in its own steps: columns D to AH of NOAA_Solar_Calculations_day.xls, in degrees and
 * minutes. Out: elevation without refraction, azimuth from north over east. */
static void noaa_angles(double julian, double minutes, double zone, double latitude, double longitude,
                        double *elevation, double *azimuth) {
    const double d = pi / 180;
    double g = (julian - 2451545) / 36525;
    double i = fmod(280.46646 + g * (36000.76983 + g * 0.0003032), 360);
    double j = 357.52911 + g * (35999.05029 - 0.0001537 * g), k = 0.016708634 - g * (0.000042037 + 0.0000001267 * g);
    double l = sin(j * d) * (1.914602 - g * (0.004817 + 0.000014 * g)) + sin(2 * j * d) * (0.019993 - 0.000101 * g) +
               sin(3 * j * d) * 0.000289;
    double p = i + l - 0.00569 - 0.00478 * sin((125.04 - 1934.136 * g) * d);
    double q = 23 + (26 + ((21.448 - g * (46.815 + g * (0.00059 - g * 0.001813)))) / 60) / 60;
    double r = q + 0.00256 * cos((125.04 - 1934.136 * g) * d), declination = asin(sin(r * d) * sin(p * d)) / d;
    double u = tan(r / 2 * d) * tan(r / 2 * d);
    double v = 4 / d *
               (u * sin(2 * i * d) - 2 * k * sin(j * d) + 4 * k * u * sin(j * d) * cos(2 * i * d) -
                0.5 * u * u * sin(4 * i * d) - 1.25 * k * k * sin(2 * j * d));
    double solar_time = fmod(minutes + v + 4 * longitude - 60 * zone + 1440, 1440);
    double hour_angle = solar_time / 4 < 0 ? solar_time / 4 + 180 : solar_time / 4 - 180;
    double zenith = acos(sin(latitude * d) * sin(declination * d) +
                         cos(latitude * d) * cos(declination * d) * cos(hour_angle * d)) /
                    d;
    double side =
        acos((sin(latitude * d) * cos(zenith * d) - sin(declination * d)) / (cos(latitude * d) * sin(zenith * d))) / d;
    *elevation = 90 - zenith;
    *azimuth = hour_angle > 0 ? fmod(side + 180, 360) : fmod(540 - side, 360);
}

TEST(the_sun_is_within_a_hundredth_of_a_degree_of_noaas_position) {
    static const struct {
        int year;
        double day, julian; /* Julian day of 0 h local time, without its zone */
        double latitude, longitude, zone;
    } observers[] = {{2000, 1, 2451544.5, 40, -105, -7},        {2025, 172, 2460847.5, 51.48, 0, 0},
                     {2024, 80, 2460389.5, -33.87, 151.21, 10}, {2010, 355, 2455551.5, 64.15, -21.94, 0},
                     {1950, 45, 2433326.5, 35.68, 139.69, 9},   {2080, 300, 2481063.5, -54.8, -68.3, -3}};
    for (size_t n = 0; n < sizeof observers / sizeof observers[0]; n++)
        for (double hour = 0.3; hour < 24; hour += 1.1) {
            double elevation, azimuth, d = pi / 180;
            noaa_angles(observers[n].julian + (hour - observers[n].zone) / 24, 60 * hour, observers[n].zone,
                        observers[n].latitude, observers[n].longitude, &elevation, &azimuth);
            struct vec3 expected = {cos(elevation * d) * sin(azimuth * d), sin(elevation * d),
                                    -cos(elevation * d) * cos(azimuth * d)};
            struct vec3 sun = sun_at(observers[n].year, observers[n].day, hour, observers[n].latitude,
                                     observers[n].longitude, observers[n].zone);
            CHECK(vec3_length(vec3_sub(sun, expected)) < 0.01 * d);
        }
}

TEST(the_sun_crosses_the_equator_and_turns_at_the_times_of_the_almanac) {
    /* Times in UTC of the U.S. Naval Observatory, "Earth's Seasons". Seen from the north pole, y is the sine of the
     * declination. */
    const double degree = pi / 180;
    CHECK_NEAR(asin(sun_at(2024, 80, 3 + 6 / 60.0, 90, 0, 0).y) / degree, 0, 0.01);         /* 20 March, 03:06 */
    CHECK_NEAR(asin(sun_at(2024, 266, 12 + 44 / 60.0, 90, 0, 0).y) / degree, 0, 0.01);      /* 22 September, 12:44 */
    CHECK_NEAR(asin(sun_at(2025, 79, 9 + 1 / 60.0, 90, 0, 0).y) / degree, 0, 0.01);         /* 20 March, 09:01 */
    CHECK_NEAR(asin(sun_at(2025, 265, 18 + 19 / 60.0, 90, 0, 0).y) / degree, 0, 0.01);      /* 22 September, 18:19 */
    CHECK_NEAR(asin(sun_at(2025, 172, 2 + 42 / 60.0, 90, 0, 0).y) / degree, 23.438, 0.01);  /* 21 June, 02:42 */
    CHECK_NEAR(asin(sun_at(2025, 355, 15 + 3 / 60.0, 90, 0, 0).y) / degree, -23.438, 0.01); /* 21 December, 15:03 */
}
