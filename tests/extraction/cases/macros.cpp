#define API
// @module_start
// @module_name A
// @DataOut RequestWhenReady
API_EXPORT(3) API Map WINAPI build(_In_ const Scan * s, IN Imu i UNUSED) NOEXCEPT;
// @DataOut RequestWhenReady
Q_INVOKABLE Map slot(Scan s) const REQUIRES(mutex_);
// @DataOut RequestWhenReady
FUNCTION(Map, build)(Scan s);
// @DataOut RequestWhenReady
template <typename T> requires std::integral<T> || (sizeof(T) > 4)
[[nodiscard]] auto Rig::
  build(T x, std::map<int, std::vector<int>> m = std::map<int, std::vector<int>>{},
    bool less = 1 < 2, bool more = 2 > 1) const & noexcept(noexcept(f()))
  -> std::expected<Frame<T>, Error>;
// @DataOut RequestWhenReady
operator Map() const;
// @DataOut RequestWhenReady
Map operator<<(Scan s);
// @DataOut RequestWhenReady
Map (*table(Scan s))[3];
// @DataOut RequestWhenReady
int old(s, i) const struct Scan *s; Imu i; { return 0; }
// @DataOut RequestWhenReady
Map spliced(Scan s, \
  Imu i);
// @DataOut RequestWhenReady
Map conditional(Scan s
#if A
  , Imu i
#else
  , Gps g
#endif
);
// @DataOut RequestWhenReady
// @Input Scan
Map conditional(Scan s
#if A
  , Imu i
#endif
);
// @module_end
