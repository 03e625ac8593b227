// The median of positive floats by counting (nn/kernels/median_log.cc): positive floats are ordered
// as their bits are, so three passes, over 11, 11 and 10 bits from the top, find it exactly. Sums of
// integers do not depend on their order.
const uint BINS = 2048u;
const uint PREFIX = 3u * BINS;  // behind the counts of the three passes: what is known of the bits
const uint RANK = PREFIX + 1u;  // of the median among the values with this prefix
