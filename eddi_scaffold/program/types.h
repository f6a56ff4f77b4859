#ifndef EDDI_EVENT_TYPES
#define EDDI_EVENT_TYPES
typedef enum { EVENT_FALSE = 0, EVENT_UNKNOWN = 1, EVENT_TRUE = 2 } event_kleene;

typedef struct {
    event_kleene verdict;
    bool active;  /* EVIDENCE: TRUE; HAZARD: TRUE or UNKNOWN */
    bool raised;  /* the verdict became TRUE in this step */
    bool cleared; /* the verdict was TRUE and is no longer */
} event_output;

typedef struct {
    uint32_t head;      /* index of the oldest sample */
    uint32_t size;      /* samples */
    uint32_t front;     /* samples of the old stack, sums only */
    uint32_t known;     /* known samples, COVERAGE only */
    uint32_t overflows; /* samples that had to go too early */
    int64_t bad;        /* time of the last sample that makes the window UNKNOWN */
    double high;        /* sum or mean of the new stack */
    double low;         /* what was rounded off, or squares, of the new stack */
} event_ring;

typedef struct {
    int64_t last;
    int64_t unknown;
} event_hold;
