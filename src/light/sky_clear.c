/* The clear sky of Preetham, Shirley and Smits, "A Practical Analytic Model for Daylight", SIGGRAPH 1999: luminance and
 * chromaticity each as Perez' function of the angles to the zenith and to the sun, with the coefficients of the paper's
 * appendix A.2; position of the sun by its appendix A.6. xyY becomes linear sRGB by the matrix of IEC 61966-2-1.
 * Luminance in kcd/m^2 is divided by 20, so that a bright blue sky comes out near 1. */
#include "light/sky_parts.h"
#include "math/elementary.h"

static double perez(const double c[5], double cos_zenith, double cos_sun) {
    double cosine = cos_zenith > 1e-3 ? cos_zenith : 1e-3; /* the function falls apart at the horizon itself */
    cos_sun = cos_sun > 1 ? 1 : cos_sun < -1 ? -1 : cos_sun;
    return (1 + c[0] * el_exp(c[1] / cosine)) * (1 + c[2] * el_exp(c[3] * el_acos(cos_sun)) + c[4] * cos_sun * cos_sun);
}

/* (T^2 T 1) M (theta^3 theta^2 theta 1) */
static double zenith_chromaticity(const double m[3][4], double turbidity, double theta) {
    double sum = 0, power = turbidity * turbidity;
    for (int i = 0; i < 3; i++) {
        sum += power * (((m[i][0] * theta + m[i][1]) * theta + m[i][2]) * theta + m[i][3]);
        power = i == 0 ? turbidity : 1;
    }
    return sum;
}

void sky_make_clear(struct vec3 sun, double turbidity, struct vec3 ground, struct sky *out) {
    static const double slope[3][5] = {{0.1787, -0.3554, -0.0227, 0.1206, -0.0670},
                                       {-0.0193, -0.0665, -0.0004, -0.0641, -0.0033},
                                       {-0.0167, -0.0950, -0.0079, -0.0441, -0.0109}};
    static const double start[3][5] = {{-1.4630, 0.4275, 5.3251, -2.5771, 0.3703},
                                       {-0.2592, 0.0008, 0.2125, -0.8989, 0.0452},
                                       {-0.2608, 0.0092, 0.2102, -1.6537, 0.0529}};
    static const double zenith_x[3][4] = {
        {0.00166, -0.00375, 0.00209, 0}, {-0.02903, 0.06377, -0.03202, 0.00394}, {0.11693, -0.21196, 0.06052, 0.25886}};
    static const double zenith_y[3][4] = {
        {0.00275, -0.00610, 0.00317, 0}, {-0.04214, 0.08970, -0.04153, 0.00516}, {0.15346, -0.26756, 0.06670, 0.26688}};
    *out = (struct sky){.kind = SKY_CLEAR};
    struct clear_sky *clear = &out->clear;
    clear->sun = sun;
    clear->ground = ground;
    double cos_sun = sun.y < 0 ? 0 : sun.y > 1 ? 1 : sun.y, theta = el_acos(cos_sun);
    double chi = (4.0 / 9 - turbidity / 120) * (PI - 2 * theta);
    double luminance = (4.0453 * turbidity - 4.9710) * el_tan(chi) - 0.2155 * turbidity + 2.4192;
    double zenith[3] = {(luminance > 0 ? luminance : 0) / 20, zenith_chromaticity(zenith_x, turbidity, theta),
                        zenith_chromaticity(zenith_y, turbidity, theta)};
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 5; k++)
            clear->perez[i][k] = slope[i][k] * turbidity + start[i][k];
        clear->scale[i] = zenith[i] / perez(clear->perez[i], 1, cos_sun);
    }
}

struct vec3 sky_clear_colour(const struct clear_sky *clear, struct vec3 d) {
    if (d.y < 0)
        return clear->ground;
    double cos_sun = vec3_dot(d, clear->sun), xyy[3];
    for (int i = 0; i < 3; i++)
        xyy[i] = clear->scale[i] * perez(clear->perez[i], d.y, cos_sun);
    double luminance = xyy[0] > 0 ? xyy[0] : 0;
    double x = xyy[1] / xyy[2] * luminance, z = (1 - xyy[1] - xyy[2]) / xyy[2] * luminance;
    struct vec3 c = {3.2406 * x - 1.5372 * luminance - 0.4986 * z, -0.9689 * x + 1.8758 * luminance + 0.0415 * z,
                     0.0557 * x - 0.2040 * luminance + 1.0570 * z};
    return vec3_max(c, vec3_all(0));
}

struct vec3 sky_sun(double day, double hour, double latitude, double longitude, double zone) {
    double time = hour + 0.170 * el_sin(4 * PI * (day - 80) / 373) - 0.129 * el_sin(2 * PI * (day - 8) / 355);
    time += (longitude - 15 * zone) / 15;
    double declination = 0.4093 * el_sin(2 * PI * (day - 81) / 368), turn = PI * (time - 12) / 12;
    double s_lat, c_lat, s_dec, c_dec, s_turn, c_turn;
    el_sincos(latitude * (PI / 180), &s_lat, &c_lat);
    el_sincos(declination, &s_dec, &c_dec);
    el_sincos(turn, &s_turn, &c_turn);
    double north = c_lat * s_dec - s_lat * c_dec * c_turn;
    return (struct vec3){-c_dec * s_turn, s_lat * s_dec + c_lat * c_dec * c_turn, -north};
}
