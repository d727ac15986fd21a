!> The tracker: the answers of the global search mostly without it, and all walls of a crease.
program test_tracker
   use lopin_kinds, only : wp, lk
   use lopin_error, only : error_type
   use lopin_cells, only : cell_type, cell_id, cell_names, new_cell_of
   use lopin_facets, only : facets_type
   use lopin_projection, only : place
   use lopin_surface, only : surface_type, new_surface, update_surface
   use lopin_feature, only : projection_type, limits_type
   use lopin_search, only : find_projection, refit_tree
   use lopin_tracker, only : tracker_type, new_tracker, begin, track, commit, restore
   use search_scenes, only : scene_type, make_sheet, make_cube, follow, allocate_facets
   use check, only : test, close_to, is_true, finish
   implicit none

   real(wp), parameter :: tight = 1.0e-12_wp
   real(wp), parameter :: degree = acos(-1.0_wp)/180.0_wp

   call random_init(.true., .false.)
   call tracking_equals_searching()
   call nothing_flickers_at_a_joint()
   call a_convex_corner_gives_one_foot()
   call a_concave_corner_gives_two()
   call a_roof_upside_down_is_symmetric()
   call a_cubic_corner_gives_three()
   call a_far_surface_is_not_asked()
   call a_thin_plate_is_left_on_the_side_of_entry()
   call nobody_is_caught_from_behind()
   call a_restored_tracker_repeats_its_bits()
   call a_hairpin_meets_itself_and_not_through_its_walls()
   call finish()

contains

   !> Random walks of the points over a sheet that also waves.
   subroutine tracking_equals_searching()
      type(scene_type) :: scene
      type(tracker_type) :: tracker
      type(projection_type) :: found
      type(limits_type) :: limits
      type(projection_type), allocatable :: result(:, :)
      type(error_type), allocatable :: error
      real(wp), allocatable :: x(:, :), x_new(:, :), side(:, :), rest(:)
      real(wp) :: size_of
      integer :: cell, i, k, ndim, differ, increment, compared
      integer, parameter :: n = 200

      call test('tracked feet are those of the global search')
      do cell = 1, 6
         call make_sheet(scene, cell, merge(9, 40, cell > 2), 0.1_wp)
         ndim = scene%surface%ndim
         call new_tracker(tracker, ndim, scene%surface%facets, n, limits, 1)
         allocate (x(ndim, n), x_new(ndim, n), side(ndim, n), result(1, n))
         rest = scene%x(ndim, :)
         call random_number(x)
         x = 0.2_wp + 0.6_wp*x
         x(ndim, :) = 0.05_wp + 0.1_wp*(x(ndim, :) - 0.5_wp)
         side = 0.0_wp
         side(ndim, :) = -1.0_wp
         differ = 0
         compared = 0
         size_of = sum(scene%surface%size)/real(scene%surface%facets%n, wp)
         do increment = 1, 5
            call begin(tracker, scene%x, x, side, 0.1_wp*size_of, result, error)
            do k = 1, 10
               call random_number(x_new)
               x = x + 0.2_wp*size_of*(x_new - 0.5_wp)
               scene%x(ndim, :) = rest*(1.0_wp + 0.02_wp*sin(real(k + 10*increment, wp)))
               call follow(scene)
               call refit_tree(scene%tree, scene%surface%low, scene%surface%high)
               call track(tracker, scene%x, x, side, result, error)
               do i = 1, n
                  call find_projection(scene%surface, scene%tree, x(:, i), side(:, i), limits, &
                     & found)
                  if (min(found%facet, 1) /= min(result(1, i)%facet, 1)) differ = differ + 1
                  if (found%facet == 0) cycle
                  ! Far points are only kept open.
                  if (abs(found%gap) > 0.5_wp*size_of) then
                     if (result(1, i)%gap < found%gap - tight .and. found%gap > 0.0_wp) &
                        & differ = differ + 1
                     cycle
                  end if
                  compared = compared + 1
                  if (abs(found%gap - result(1, i)%gap) > 1.0e-7_wp*size_of) differ = differ + 1
                  if (norm2(found%point - result(1, i)%point) > 1.0e-6_wp*size_of) &
                     & differ = differ + 1
               end do
            end do
            call commit(tracker)
         end do
         call is_true(trim(cell_names(cell))//' the same', differ == 0)
         call is_true('many compared', compared > 500)
         call is_true('mostly without the tree', tracker%counts%query < &
            & tracker%counts%tracked/4_lk)
         deallocate (x, x_new, side, result)
      end do
   end subroutine tracking_equals_searching

   subroutine nothing_flickers_at_a_joint()
      type(scene_type) :: scene
      type(tracker_type) :: tracker
      type(limits_type) :: limits
      type(projection_type) :: result(1, 1)
      type(error_type), allocatable :: error
      integer :: k, owner, cell

      call test('a point that trembles on a joint keeps its facet')
      do cell = 1, 6
         call make_sheet(scene, cell, 4, 0.0_wp)
         call new_tracker(tracker, scene%surface%ndim, scene%surface%facets, 1, limits, 1)
         associate (n => scene%surface%ndim)
            call begin(tracker, scene%x, at(n, 0.5_wp), down(n), 0.0_wp, result, error)
            owner = result(1, 1)%facet
            do k = 1, 20
               call track(tracker, scene%x, at(n, 0.5_wp + 1.0e-8_wp*(-1)**k), down(n), result, &
                  & error)
               call is_true(trim(cell_names(cell))//' the same facet', result(1, 1)%facet == owner)
               call is_true('a face', result(1, 1)%place == place%inside)
               call close_to('gap', result(1, 1)%gap, 0.0_wp, tight)
            end do
         end associate
      end do
   end subroutine nothing_flickers_at_a_joint

   pure function at(n, x1) result(x)
      integer, intent(in) :: n
      real(wp), intent(in) :: x1
      real(wp) :: x(n, 1)
      x = 0.37_wp
      x(1, 1) = x1
      x(n, 1) = 0.0_wp
   end function at

   pure function down(n) result(x)
      integer, intent(in) :: n
      real(wp) :: x(n, 1)
      x = 0.0_wp
      x(n, 1) = -1.0_wp
   end function down

   !> An open polyline, its outside on the right of the way.
   subroutine make_polyline(facets, n)
      type(facets_type), intent(out) :: facets
      integer, intent(in) :: n                 !! segments
      type(cell_type) :: shape
      integer :: i

      call new_cell_of(shape, cell_id%line2)
      call allocate_facets(facets, n, shape)
      do i = 1, n
         facets%node(:2, i) = [i, i + 1]
      end do
   end subroutine make_polyline

   !> The corner at the origin of the quadrant x < 0, y < 0.
   subroutine a_convex_corner_gives_one_foot()
      type(facets_type) :: facets
      type(tracker_type) :: tracker
      type(limits_type) :: limits
      type(projection_type) :: result(2, 1)
      type(error_type), allocatable :: error
      real(wp) :: x(2, 3), p(2, 1), none(2, 1), old
      integer :: i

      call test('dropped on a convex corner at 45 degrees: one foot, normal in the cone')
      call make_polyline(facets, 2)
      x = reshape([0.0_wp, -1.0_wp, 0.0_wp, 0.0_wp, -1.0_wp, 0.0_wp], [2, 3])
      call new_tracker(tracker, 2, facets, 1, limits, 2)
      none = 0.0_wp
      do i = -1, 1
         p(:, 1) = 0.1_wp*[cos(45.0_wp*degree + i*1.0e-12_wp), sin(45.0_wp*degree + i*1.0e-12_wp)]
         call begin(tracker, x, p, none, 0.1_wp, result, error)
         call is_true('one foot', count(result(:, 1)%facet > 0) == 1)
         call close_to('gap', result(1, 1)%gap, 0.1_wp, tight)
         call close_to('normal', result(1, 1)%normal(:2), p(:, 1)/0.1_wp, tight)
      end do
      p(:, 1) = 0.0_wp
      call track(tracker, x, p, none, result, error)
      call is_true('on the corner itself', all(result(1, 1)%normal(:2) > -tight))
      old = 0.0_wp
      do i = 0, 400
         p(:, 1) = [-0.2_wp + 0.001_wp*i, 0.2_wp - 0.001_wp*i]
         call track(tracker, x, p, none, result, error)
         call is_true('claimed', count(result(:, 1)%facet > 0) == 1)
         if (i > 0) call is_true('no jump', abs(maxval(result(:, 1)%gap) - old) <= 0.0015_wp)
         old = maxval(result(:, 1)%gap)
      end do
   end subroutine a_convex_corner_gives_one_foot

   !> The corner at the origin of the free quadrant x > 0, y > 0; a force (3, 4) gives (3, 4).
   subroutine a_concave_corner_gives_two()
      type(facets_type) :: facets
      type(tracker_type) :: tracker
      type(limits_type) :: limits
      type(projection_type) :: result(2, 1)
      type(error_type), allocatable :: error
      real(wp) :: x(2, 3), p(2, 1), side(2, 1), reaction(2), a(2, 2), old
      integer :: i, k

      call test('in a concave corner a point has one foot on each wall')
      call make_polyline(facets, 2)
      x = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 3])
      call new_tracker(tracker, 2, facets, 1, limits, 2)
      side(:, 1) = [-sqrt(0.5_wp), -sqrt(0.5_wp)]
      p(:, 1) = [0.2_wp, 0.1_wp]
      call begin(tracker, x, p, side, 0.1_wp, result, error)
      do i = 0, 24
         p(:, 1) = [0.1_wp*(mod(i, 5) - 2), 0.1_wp*(i/5 - 2)]
         call track(tracker, x, p, side, result, error)
         call is_true('two feet', all(result(:, 1)%facet > 0))
         call close_to('gap of the floor', result(1, 1)%gap, p(2, 1), tight)
         call close_to('gap of the wall', result(2, 1)%gap, p(1, 1), tight)
         a(:, 1) = result(1, 1)%normal(:2)
         a(:, 2) = result(2, 1)%normal(:2)
         reaction = [(a(1, k), k=1, 2)]
         reaction = [a(2, 2)*3.0_wp - a(1, 2)*4.0_wp, a(1, 1)*4.0_wp - a(2, 1)*3.0_wp]/(a(1, &
            & 1)*a(2, 2) - a(1, 2)*a(2, 1))
         call close_to('reactions', reaction, [4.0_wp, 3.0_wp], tight)
      end do
      call test('in the middle of a wall the other one is not met from behind')
      p(:, 1) = [-0.05_wp, 0.9_wp]
      old = -0.05_wp
      call begin(tracker, x, p, side, 0.1_wp, result, error)
      call close_to('wall', minval(result(:, 1)%gap), old, tight)
   end subroutine a_concave_corner_gives_two

   !> Benchmark F11: a roof of 10 degrees, valley side up.
   subroutine a_roof_upside_down_is_symmetric()
      type(facets_type) :: facets
      type(tracker_type) :: tracker
      type(limits_type) :: limits
      type(projection_type) :: result(2, 1)
      type(error_type), allocatable :: error
      real(wp) :: x(2, 3), p(2, 1), side(2, 1), force(2)
      integer :: i

      call test('in the valley of two facets at 10 degrees the force has no component aside')
      call make_polyline(facets, 2)
      x(:, 1) = [-1.0_wp, tan(10.0_wp*degree)]
      x(:, 2) = 0.0_wp
      x(:, 3) = [1.0_wp, tan(10.0_wp*degree)]
      x = x(:, [3, 2, 1])
      call new_tracker(tracker, 2, facets, 1, limits, 2)
      side(:, 1) = [0.0_wp, -1.0_wp]
      do i = -3, 3
         p(:, 1) = [0.0_wp, 0.02_wp*i]
         if (i == -3) then
            call begin(tracker, x, p, side, 0.1_wp, result, error)
         else
            call track(tracker, x, p, side, result, error)
         end if
         call is_true('both', all(result(:, 1)%facet > 0))
         force = result(1, 1)%gap*result(1, 1)%normal(:2) + result(2, 1)%gap*result(2, 1)%normal(:2)
         call close_to('aside', force(1), 0.0_wp, tight)
         call close_to('gap', result(:, 1)%gap, spread(p(2, 1)*cos(10.0_wp*degree), 1, 2), tight)
      end do
   end subroutine a_roof_upside_down_is_symmetric

   !> The inside of a cube turned inside out: near a corner three walls.
   subroutine a_cubic_corner_gives_three()
      type(scene_type) :: scene
      type(tracker_type) :: tracker
      type(limits_type) :: limits
      type(projection_type) :: result(3, 1)
      type(error_type), allocatable :: error
      real(wp) :: p(3, 1), side(3, 1), gap(3)
      integer :: i, k, cell

      call test('in a corner of a box three walls are met')
      do cell = 1, 2
         call make_cube(scene, 3, cell == 2)
         scene%x(1, :) = -scene%x(1, :)        ! mirrored: the outside is within
         call new_tracker(tracker, 3, scene%surface%facets, 1, limits, 3)
         side = sqrt(1.0_wp/3.0_wp)
         do i = 0, 26
            p(:, 1) = 1.0_wp - 0.05_wp - [0.1_wp*mod(i, 3), 0.1_wp*mod(i/3, 3), 0.1_wp*(i/9)] + &
               & 0.1_wp
            if (i == 0) call begin(tracker, scene%x, p, side, 0.1_wp, result, error)
            call track(tracker, scene%x, p, side, result, error)
            call is_true('three feet', all(result(:, 1)%facet > 0))
            gap = 0.0_wp
            do k = 1, 3
               gap = gap - result(k, 1)%gap*result(k, 1)%normal
            end do
            call close_to('gaps', gap, 1.0_wp - p(:, 1), tight)
         end do
      end do
   end subroutine a_cubic_corner_gives_three

   subroutine a_far_surface_is_not_asked()
      type(scene_type) :: scene
      type(tracker_type) :: tracker
      type(limits_type) :: limits
      type(projection_type), allocatable :: result(:, :)
      type(error_type), allocatable :: error
      real(wp), allocatable :: x(:, :), side(:, :)
      integer :: k

      call test('a pair far away costs one box, no query and no projection')
      call make_sheet(scene, cell_id%quad, 100, 0.1_wp)
      allocate (x(3, 500), side(3, 500), result(2, 500))
      call random_number(x)
      x(3, :) = x(3, :) + 2.0_wp
      side = spread([0.0_wp, 0.0_wp, -1.0_wp], 2, 500)
      call new_tracker(tracker, 3, scene%surface%facets, 500, limits, 2)
      do k = 1, 10
         call begin(tracker, scene%x, x, side, 0.01_wp, result, error)
         call track(tracker, scene%x, x, side, result, error)
         call is_true('nothing opposite', all(result%facet == 0))
      end do
      call is_true('no query', tracker%counts%query == 0 .and. tracker%counts%projection == 0)
      call is_true('ten boxes', tracker%counts%box == 10)
      call test('it wakes when it comes near in one stroke')
      x(3, :) = x(3, :) - 1.9_wp
      call track(tracker, scene%x, x, side, result, error)
      call is_true('searched', tracker%counts%query >= 500)
      call is_true('met', count(result(1, :)%facet > 0) > 400)
   end subroutine a_far_surface_is_not_asked

   !> Benchmark F10: a plate of thickness 1, entered by 0.6 from above.
   subroutine a_thin_plate_is_left_on_the_side_of_entry()
      type(scene_type) :: scene
      type(tracker_type) :: tracker
      type(limits_type) :: limits
      type(projection_type) :: result(1, 1)
      type(error_type), allocatable :: error
      real(wp) :: p(3, 1), side(3, 1)
      integer :: k

      call test('a plate of thickness 1 entered by 0.6 pushes back to the side of entry')
      call make_cube(scene, 4, .false.)
      scene%x(:2, :) = 4.0_wp*scene%x(:2, :)
      scene%x(3, :) = 0.5_wp*scene%x(3, :)
      side(:, 1) = [0.0_wp, 0.0_wp, -1.0_wp]
      p(:, 1) = [0.3_wp, 0.2_wp, -0.1_wp]
      do k = 1, 2
         call new_tracker(tracker, 3, scene%surface%facets, 1, limits, 1)
         if (k == 2) then
            call begin(tracker, scene%x, p + 0.65_wp*reshape([0, 0, 1], [3, 1]), side, 0.1_wp, &
               & result, error)
            call commit(tracker)
            call track(tracker, scene%x, p, side, result, error)
         else
            call begin(tracker, scene%x, p, side, 0.1_wp, result, error)
         end if
         call is_true('met', result(1, 1)%facet > 0)
         call close_to('gap', result(1, 1)%gap, -0.6_wp, tight)
         call close_to('up', result(1, 1)%normal, [0.0_wp, 0.0_wp, 1.0_wp], tight)
      end do
   end subroutine a_thin_plate_is_left_on_the_side_of_entry

   !> The lower face of a sheet under a tool: the tool's upper face looks at it, through the tool.
   subroutine nobody_is_caught_from_behind()
      type(scene_type) :: scene
      type(tracker_type) :: tracker
      type(limits_type) :: limits
      type(projection_type) :: result(1, 2)
      type(error_type), allocatable :: error
      real(wp) :: p(3, 2), side(3, 2)

      call test('a sheet below a tool is met by its upper face only')
      call make_cube(scene, 4, .true.)
      scene%x(3, :) = 0.05_wp*scene%x(3, :)
      p = reshape([0.1_wp, 0.2_wp, -0.06_wp, 0.1_wp, 0.2_wp, -0.10_wp], [3, 2])
      side = reshape([0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, -1.0_wp], [3, 2])
      call new_tracker(tracker, 3, scene%surface%facets, 2, limits, 1)
      call begin(tracker, scene%x, p, side, 0.01_wp, result, error)
      call close_to('upper face of the sheet', result(1, 1)%gap, 0.01_wp, tight)
      call is_true('lower face of the sheet', result(1, 2)%facet == 0)
      call track(tracker, scene%x, p, side, result, error)
      call is_true('also later', result(1, 2)%facet == 0)
   end subroutine nobody_is_caught_from_behind

   subroutine a_restored_tracker_repeats_its_bits()
      type(scene_type) :: scene
      type(tracker_type) :: tracker
      type(limits_type) :: limits
      type(projection_type), allocatable :: first(:, :), again(:, :)
      type(error_type), allocatable :: error
      real(wp), allocatable :: x(:, :), side(:, :), step(:, :, :)
      integer :: k, turn
      integer, parameter :: n = 100

      call test('run, roll back, run again: the same bits')
      call make_sheet(scene, cell_id%quad, 20, 0.1_wp)
      allocate (x(3, n), side(3, n), step(3, n, 4), first(2, n), again(2, n))
      call random_number(x)
      call random_number(step)
      x(3, :) = 0.1_wp*x(3, :)
      side = spread([0.0_wp, 0.0_wp, -1.0_wp], 2, n)
      call new_tracker(tracker, 3, scene%surface%facets, n, limits, 2)
      call begin(tracker, scene%x, x, side, 0.01_wp, first, error)
      call commit(tracker)
      do turn = 1, 2
         call begin(tracker, scene%x, x, side, 0.01_wp, again, error)
         do k = 1, 4
            call track(tracker, scene%x, x + 0.03_wp*step(:, :, k), side, again, error)
         end do
         if (turn == 1) first = again
         call restore(tracker)
      end do
      call is_true('facets', all(first%facet == again%facet))
      do k = 1, 3
         call is_true('feet', .not. any(abs(first%point(k) - again%point(k)) > 0.0_wp))
      end do
   end subroutine a_restored_tracker_repeats_its_bits

   !> The skin of a U of two arms of thickness t and length 4, its slot of width w open at x = 4;
   !> in space one unit deep.
   subroutine make_hairpin(facets, x, ndim, t, w)
      type(facets_type), intent(out) :: facets
      real(wp), allocatable, intent(out) :: x(:, :)
      integer, intent(in) :: ndim
      real(wp), intent(in) :: t, w
      type(cell_type) :: shape
      real(wp) :: corner(2, 9)
      real(wp), allocatable :: outline(:, :)
      integer :: i, k, m, n, parts
      integer, parameter :: layers = 4

      corner(1, :) = [-t, 4.0_wp, 4.0_wp, 0.0_wp, 0.0_wp, 4.0_wp, 4.0_wp, -t, -t]
      corner(2, :) = [0.0_wp, 0.0_wp, t, t, t + w, t + w, 2*t + w, 2*t + w, 0.0_wp]
      allocate (outline(2, 0))
      do k = 1, 8
         parts = max(2, nint(norm2(corner(:, k + 1) - corner(:, k))/0.25_wp))
         do i = 0, parts - 1
            outline = reshape([outline, corner(:, k) + real(i, wp)/real(parts, wp)*(corner(:, &
               & k + 1) - corner(:, k))], [2, size(outline, 2) + 1])
         end do
      end do
      n = size(outline, 2)
      m = merge(0, layers, ndim == 2)
      allocate (x(ndim, n*(m + 1)))
      do k = 0, m
         x(:2, k*n + 1:(k + 1)*n) = outline
         if (ndim == 3) x(3, k*n + 1:(k + 1)*n) = real(k, wp)/real(layers, wp)
      end do
      call new_cell_of(shape, merge(cell_id%line2, cell_id%quad, ndim == 2))
      call allocate_facets(facets, n*max(m, 1), shape)
      do k = 0, max(m, 1) - 1
         do i = 1, n
            facets%node(:2, k*n + i) = k*n + [i, 1 + mod(i, n)]
            if (ndim == 3) facets%node(3:4, k*n + i) = (k + 1)*n + [1 + mod(i, n), i]
         end do
      end do
   end subroutine make_hairpin

   subroutine a_hairpin_meets_itself_and_not_through_its_walls()
      type(facets_type) :: facets
      type(tracker_type) :: tracker
      type(limits_type) :: limits
      type(surface_type) :: skin
      type(projection_type), allocatable :: result(:, :)
      type(error_type), allocatable :: error
      real(wp), allocatable :: x(:, :), moved(:, :)
      real(wp), parameter :: t = 0.1_wp, w = 0.5_wp
      real(wp) :: gap, height
      integer :: ndim, i, k, inner, outer, wrong

      call test('a thin hairpin meets itself across its slot, never through its walls')
      do ndim = 2, 3
         call make_hairpin(facets, x, ndim, t, w)
         call new_surface(skin, ndim, facets)
         call update_surface(skin, x, error)
         call new_tracker(tracker, ndim, facets, skin%nnode, limits, 1, own_node=skin%node)
         allocate (result(1, skin%nnode))
         moved = x
         do k = 0, 5
            ! The upper arm comes down by w in five strokes, and enters by a fifth of the wall.
            gap = w*(1.0_wp - real(k, wp)/5.0_wp)
            if (k == 5) gap = -0.02_wp
            where (x(2, :) > t + 0.5_wp*w) moved(2, :) = x(2, :) + gap - w
            if (k == 0) then
               call begin(tracker, moved, moved(:, skin%node), skin%pseudo(:ndim, :), 0.1_wp, &
                  & result, error)
               call commit(tracker)
            else
               call track(tracker, moved, moved(:, skin%node), skin%pseudo(:ndim, :), result, error)
            end if
            inner = 0
            outer = 0
            wrong = 0
            do i = 1, skin%nnode
               if (x(1, skin%node(i)) < 0.6_wp .or. x(1, skin%node(i)) > 3.8_wp) cycle
               height = x(2, skin%node(i)) - t
               if (abs(height) < 1.0e-9_wp .or. abs(height - w) < 1.0e-9_wp) then
                  inner = inner + 1
                  if (result(1, i)%facet == 0 .or. abs(result(1, i)%gap - gap) > 1.0e-9_wp) &
                     & wrong = wrong + 1
               else
                  outer = outer + 1
                  if (result(1, i)%facet > 0) wrong = wrong + 1
               end if
            end do
            call is_true('faces of both kinds', inner > 20 .and. outer > 20)
            call is_true('all right', wrong == 0)
         end do
         deallocate (result)
      end do
   end subroutine a_hairpin_meets_itself_and_not_through_its_walls
end program test_tracker
