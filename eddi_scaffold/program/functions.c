/* Windows, comparisons and filters of monitors in C99: each monitor gets the functions that it calls.
 *
 * The algorithms are those of eddi_runtime.expressions.windows, in the same order. Buffers are rings
 * whose size is a power of two; the arrays lie in the monitor's struct and are passed next to the
 * ring, so that a struct can be copied as a whole. Blank lines separate functions. What begins with
 * FOLD stands behind each function that gathers, under its name.
 */

/* 0 is FALSE, 1 UNKNOWN, 2 TRUE. */
static int less(double a, double b)
{
    return a < b ? 2 : a >= b ? 0 : 1;
}

static int less_or_equal(double a, double b)
{
    return a <= b ? 2 : a > b ? 0 : 1;
}

static int equal(double a, double b)
{
    return a == b ? 2 : (a < b || a > b) ? 0 : 1;
}

static int same_truth(int a, int b)
{
    return (a == 1 || b == 1) ? 1 : a == b ? 2 : 0;
}

static int same_literal(int a, int b)
{
    return (a < 0 || b < 0) ? 1 : a == b ? 2 : 0;
}

static int least(int a, int b)
{
    return a < b ? a : b;
}

static int greatest(int a, int b)
{
    return a > b ? a : b;
}

static void ring_reset(event_ring *r)
{
    r->head = 0u;
    r->size = 0u;
    r->front = 0u;
    r->known = 0u;
    r->bad = INT64_MIN;
    r->high = 0.0;
    r->low = 0.0;
}

static void ring_drop(event_ring *r, uint32_t capacity)
{
    r->head = (r->head + 1u) & (capacity - 1u);
    r->size--;
}

static void ring_expire(event_ring *r, const int64_t *ts, uint32_t capacity, int64_t start)
{
    while (r->size > 0u && ts[r->head] <= start) {
        ring_drop(r, capacity);
    }
}

static uint32_t ring_append(event_ring *r, int64_t *ts, uint32_t capacity, int64_t t)
{
    uint32_t at;
    if (r->size == capacity) {
        ring_drop(r, capacity);
        r->overflows++;
        r->bad = t;
    }
    at = (r->head + r->size) & (capacity - 1u);
    ts[at] = t;
    r->size++;
    return at;
}

static void queue_add(event_ring *r, int64_t *ts, double *xs, uint32_t capacity, int64_t t,
                      double x)
{
    xs[ring_append(r, ts, capacity, t)] = x;
}

static void max_add(event_ring *r, int64_t *ts, double *xs, uint32_t capacity, int64_t t,
                    double x)
{
    while (r->size > 0u && xs[(r->head + r->size - 1u) & (capacity - 1u)] <= x) {
        r->size--;
    }
    queue_add(r, ts, xs, capacity, t, x);
}

static void min_add(event_ring *r, int64_t *ts, double *xs, uint32_t capacity, int64_t t,
                    double x)
{
    while (r->size > 0u && xs[(r->head + r->size - 1u) & (capacity - 1u)] >= x) {
        r->size--;
    }
    queue_add(r, ts, xs, capacity, t, x);
}

static double rate_value(const event_ring *r, const int64_t *ts, const double *xs,
                         uint32_t capacity)
{
    uint32_t last = (r->head + r->size - 1u) & (capacity - 1u);
    double value;
    if (ts[r->head] == ts[last]) {
        return NAN;
    }
    value = (xs[last] - xs[r->head]) / ((double)(ts[last] - ts[r->head]) / 1e9);
    return isfinite(value) ? value : NAN;
}

/* The first index in a sorted array whose value is not less than x. */
static uint32_t sorted_place(const double *sorted, uint32_t size, double x)
{
    uint32_t low = 0u, high = size;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2u;
        if (sorted[middle] < x) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return low;
}

static void sorted_remove(double *sorted, uint32_t size, double x)
{
    uint32_t k;
    for (k = sorted_place(sorted, size, x); k + 1u < size; k++) {
        sorted[k] = sorted[k + 1u];
    }
}

static void median_expire(event_ring *r, const int64_t *ts, const double *xs, double *sorted,
                          uint32_t capacity, int64_t start)
{
    while (r->size > 0u && ts[r->head] <= start) {
        sorted_remove(sorted, r->size, xs[r->head]);
        ring_drop(r, capacity);
    }
}

/* Worst case: as many moves as there are samples. */
static void median_add(event_ring *r, int64_t *ts, double *xs, double *sorted, uint32_t capacity,
                       int64_t t, double x)
{
    uint32_t k, place;
    if (r->size == capacity) {
        sorted_remove(sorted, r->size, xs[r->head]);
    }
    queue_add(r, ts, xs, capacity, t, x);
    place = sorted_place(sorted, r->size - 1u, x);
    for (k = r->size - 1u; k > place; k--) {
        sorted[k] = sorted[k - 1u];
    }
    sorted[place] = x;
}

static double median_value(const event_ring *r, const double *sorted)
{
    uint32_t middle = r->size / 2u;
    double high = sorted[middle];
    double low = (r->size % 2u) ? high : sorted[middle - 1u];
    double value;
    if (low == high) {
        return high;
    }
    value = 0.5 * low + 0.5 * high;
    return isfinite(value) ? value : NAN;
}

/* Compensated (Neumaier 1974). */
static void sum_gather(event_ring *r, double x, uint32_t count)
{
    double total = r->high + x;
    (void)count;
    if (fabs(r->high) >= fabs(x)) {
        r->low += (r->high - total) + x;
    } else {
        r->low += (x - total) + r->high;
    }
    r->high = total;
}

static void FOLD_turn(event_ring *r, const int64_t *ts, const double *xs, double *highs,
                     double *lows, uint32_t capacity, int64_t start)
{
    uint32_t k, count = 0u;
    r->high = 0.0;
    r->low = 0.0;
    for (k = r->size; k > 0u; k--) {
        uint32_t at = (r->head + k - 1u) & (capacity - 1u);
        if (ts[at] <= start) {
            break;
        }
        count++;
        FOLD_gather(r, xs[at], count);
        highs[at] = r->high;
        lows[at] = r->low;
    }
    r->head = (r->head + r->size - count) & (capacity - 1u);
    r->size = count;
    r->front = count;
    r->high = 0.0;
    r->low = 0.0;
}

/* Worst case once in a turn of the window: as many sums as there are samples. */
static void FOLD_expire(event_ring *r, const int64_t *ts, const double *xs, double *highs,
                       double *lows, uint32_t capacity, int64_t start)
{
    while (r->front > 0u && ts[r->head] <= start) {
        ring_drop(r, capacity);
        r->front--;
    }
    if (r->front == 0u && r->size > 0u && ts[r->head] <= start) {
        FOLD_turn(r, ts, xs, highs, lows, capacity, start);
    }
}

static void FOLD_add(event_ring *r, int64_t *ts, double *xs, double *highs, double *lows,
                    uint32_t capacity, int64_t t, double x)
{
    if (r->size == capacity) {
        if (r->front == 0u) {
            FOLD_turn(r, ts, xs, highs, lows, capacity, INT64_MIN);
        }
        r->front--;
    }
    queue_add(r, ts, xs, capacity, t, x);
    FOLD_gather(r, x, r->size - r->front);
}

/* Mean and squares (Welford 1962). */
static void stddev_gather(event_ring *r, double x, uint32_t count)
{
    double away = x - r->high;
    r->high += away / (double)count;
    r->low += away * (x - r->high);
}

static double sum_value(const event_ring *r, const double *highs, const double *lows)
{
    double total, rest, high;
    if (r->front == 0u) {
        total = r->high + r->low;
    } else {
        high = highs[r->head];
        total = high + r->high;
        if (fabs(high) >= fabs(r->high)) {
            rest = (high - total) + r->high;
        } else {
            rest = (r->high - total) + high;
        }
        total += rest + (lows[r->head] + r->low);
    }
    return isfinite(total) ? total : NAN;
}

static double stddev_value(const event_ring *r, const double *means, const double *squares)
{
    uint32_t fresh = r->size - r->front;
    double value = r->low;
    if (r->size < 2u) {
        return NAN;
    }
    if (r->front > 0u) {
        value = squares[r->head] + value;
        if (fresh > 0u) { /* Chan, Golub, LeVeque 1979 */
            double away = r->high - means[r->head];
            value += away * away * ((double)r->front * (double)fresh / (double)(r->front + fresh));
        }
    }
    value = value / (double)(r->size - 1u);
    return isfinite(value) ? sqrt(value) : NAN;
}

/* All samples and which are known; the windows over the known ones are separate. */
static void covered_add(event_ring *r, int64_t *ts, bool *ks, uint32_t capacity, int64_t t,
                        int64_t start, bool known)
{
    while (r->size > 0u && ts[r->head] <= start) {
        r->known -= ks[r->head] ? 1u : 0u;
        ring_drop(r, capacity);
    }
    if (r->size == capacity) {
        r->known -= ks[r->head] ? 1u : 0u;
    }
    ks[ring_append(r, ts, capacity, t)] = known;
    r->known += known ? 1u : 0u;
}

/* TIME (dominant 0) and ONCE (dominant 2): AND and OR by the last times of two values. */
static int hold_push(event_hold *h, int64_t start, int64_t t, bool full, int dominant, int x)
{
    if (x == dominant) {
        h->last = t;
    } else if (x == 1) {
        h->unknown = t;
    }
    if (h->last > start) {
        return dominant;
    }
    if (!full || h->unknown > start) {
        return 1;
    }
    return 2 - dominant;
}

/* Loss at once, gain after as many TRUE samples in a row as are needed. */
static int debounced(uint32_t *in_a_row, int *held, uint32_t needed, int x)
{
    if (x != 2) {
        *in_a_row = 0u;
        *held = x;
    } else if (*in_a_row < needed) {
        *in_a_row += 1u;
        *held = *in_a_row == needed ? 2 : *held;
    }
    return *held;
}

/* Strict majority of the samples that are there; s: how many, the next place, how many are TRUE,
 * how many are not FALSE. */
static int majority(uint32_t *s, unsigned char *xs, uint32_t window, int x)
{
    if (s[0] == window) {
        s[2] -= xs[s[1]] == 2u ? 1u : 0u;
        s[3] -= xs[s[1]] != 0u ? 1u : 0u;
    } else {
        s[0]++;
    }
    xs[s[1]] = (unsigned char)x;
    s[1] = (s[1] + 1u) % window;
    s[2] += x == 2 ? 1u : 0u;
    s[3] += x != 0 ? 1u : 0u;
    return 2u * s[2] > s[0] ? 2 : 2u * s[3] > s[0] ? 1 : 0;
}

static void publish(event_output *event, int verdict, bool hazard)
{
    bool before = event->verdict == EVENT_TRUE;
    event->verdict = (event_kleene)verdict;
    event->raised = verdict == 2 && !before;
    event->cleared = verdict != 2 && before;
    event->active = verdict == 2 || (hazard && verdict == 1);
}
