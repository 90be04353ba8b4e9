package a

// @module_start
// @module_name A
// @DataOut RequestWhenReady
func (a *A) Watch(ctx context.Context, in <-chan *Scan, at time.Time, cb func(int) error) (<-chan Map, error) {
	x := `// @module_end`
}

// @DataOut RequestWhenReady
func Many(a, b []Scan, m map[string]*Pose, rest ...pkg.Imu) (x, y Map) { return }

// @DataOut RequestWhenReady
func Fails(s Scan) error { return nil }

// @DataOut RequestWhenReady
type X struct{}

/*
@DataOut RequestWhenReady
*/
func Generic[T any](x Topic[T]) Frame[T]

// @module_end
