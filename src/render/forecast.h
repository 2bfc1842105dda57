/* What the tiles that are not made yet will take, learned from those that are. Before the first tile a few rays go
 * through each (forecast_look); afterwards a tile that is done says what it took (forecast_done), and the forecast is
 * the combination of what the rays saw that fits these tiles best. Costs are in any unit, say nanoseconds. */
#ifndef GRAY_RENDER_FORECAST_H
#define GRAY_RENDER_FORECAST_H

#include "render/film.h"

enum { FORECAST_TERMS = 6 };

/* One worker's sums: it alone writes them, anybody reads. */
struct forecast_sums {
    _Atomic double products[FORECAST_TERMS][FORECAST_TERMS], costs[FORECAST_TERMS]; /* weighted, of tiles done */
    _Atomic double done[FORECAST_TERMS];
    _Atomic double weight, cost, first_cost;
    _Atomic uint32_t tile;  /* under way, or FORECAST_NO_TILE */
    _Atomic double share;   /* of the tile, that this worker makes */
    _Atomic double part[2]; /* of its first pass and of the second, 0..1 */
};
#define FORECAST_NO_TILE UINT32_MAX

struct forecast {
    uint32_t count, across;
    int workers;
    float (*terms)[FORECAST_TERMS]; /* of each tile; all 0: not looked at, not to be made */
    double all[FORECAST_TERMS];     /* their sums */
    struct forecast_sums *sums;     /* of each worker */
};

/* Tiles are numbered row by row, `across` in a row. False: no memory; forecast_destroy is fine in any case. */
bool forecast_create(struct forecast *forecast, uint32_t count, uint32_t across, int workers);
void forecast_destroy(struct forecast *forecast);

/* pixels > 0; cost: of the rays; edges: between how many of neighbouring rays the picture changes, 0..1. Tiles may be
 * looked at by several threads at once, each tile once. */
void forecast_look(struct forecast *forecast, uint32_t tile, double pixels, double cost, double edges);
/* After the last look, before the first tile. */
void forecast_settle(struct forecast *forecast);

/* The worker begins a tile, or that share of it; is so far with its first or second pass; has done it. */
void forecast_begin(struct forecast *forecast, int worker, uint32_t tile, double share);
void forecast_part(struct forecast *forecast, int worker, int pass, double part);
void forecast_done(struct forecast *forecast, int worker, double cost, double first_pass_cost);

/* Work that is done and that is left, in a unit of its own: with what was done in a time, the rest takes that time
 * times left / done. film: what others have made counts, too (a farm); else NULL. At any time, from any thread. */
struct forecast_work {
    double done, left;
};
struct forecast_work forecast_work(const struct forecast *forecast, const struct film *film);

#endif
