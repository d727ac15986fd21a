!> Times of the contact search, one thread, as a Markdown table (docs/search.md).
program bench_search
   use lopin_shared_work, only : set_threads_of_run
   use lopin_kinds, only : wp, lk
   use lopin_error, only : error_type
   use lopin_cells, only : cell_id
   use lopin_surface, only : update_surface
   use lopin_feature, only : projection_type, limits_type
   use lopin_search, only : tree_type, build_tree, refit_tree, find_projections
   use lopin_tool, only : foot_type
   use lopin_tool_sphere, only : sphere_type, new_sphere
   use search_scenes, only : scene_type, make_sheet
   implicit none

   integer :: k

   call set_threads_of_run(1)
   print '(a)', '| facets | points | follow nodes [ns/facet] | build [ns/facet] '// &
      & '| refit [ns/facet] | global [ns/query] | analytic sphere [ns] |'
   print '(a)', '| --- | --- | --- | --- | --- | --- | --- |'
   do k = 1, 4
      call measure(nint(sqrt(10.0_wp**(k + 2))), min(10**(k + 2), 100000))
   end do

contains

   real(wp) function now()
      integer(lk) :: ticks, rate
      call system_clock(ticks, rate)
      now = real(ticks, wp)/real(rate, wp)
   end function now

   subroutine measure(side, n)
      integer, intent(in) :: side          !! facets along an edge
      integer, intent(in) :: n             !! points
      type(scene_type) :: scene
      type(tree_type) :: tree
      type(limits_type) :: limits
      type(projection_type), allocatable :: found(:)
      type(error_type), allocatable :: error
      real(wp), allocatable :: x(:, :), normal(:, :)
      real(wp) :: t(0:4), per_facet, per_point, h

      call make_sheet(scene, cell_id%quad, side, 0.1_wp)
      h = 1.0_wp/real(side, wp)
      call place_points(n, h, x, normal)
      allocate (found(n))
      t(0) = now()
      call update_surface(scene%surface, scene%x, error)
      t(1) = now()
      call build_tree(tree, scene%surface%low, scene%surface%high)
      t(2) = now()
      call refit_tree(tree, scene%surface%low, scene%surface%high)
      t(3) = now()
      call find_projections(scene%surface, tree, x, normal, limits, found)
      t(4) = now()
      per_facet = 1.0e9_wp/real(side**2, wp)
      per_point = 1.0e9_wp/real(n, wp)
      print '("| ",i0," | ",i0,4(" | ",f0.1)," | ",f0.1," |")', side**2, n, &
         & (t(1) - t(0))*per_facet, (t(2) - t(1))*per_facet, (t(3) - t(2))*per_facet, &
         & (t(4) - t(3))*per_point, analytic(x)
   end subroutine measure

   !> Points in the order of a slave mesh: rows over the sheet, within a tenth of a facet of it.
   subroutine place_points(n, h, x, normal)
      integer, intent(in) :: n
      real(wp), intent(in) :: h
      real(wp), allocatable, intent(out) :: x(:, :), normal(:, :)
      integer :: i, row

      row = nint(sqrt(real(n, wp)))
      allocate (x(3, n), normal(3, n))
      call random_number(x)
      normal = spread([0.0_wp, 0.0_wp, -1.0_wp], 2, n)
      do i = 1, n
         x(1, i) = 0.05_wp + 0.9_wp*(real(mod(i - 1, row), wp) + 0.3_wp*x(1, i))/real(row, wp)
         x(2, i) = 0.05_wp + 0.9_wp*min(1.0_wp, (real((i - 1)/row, wp) + &
            & 0.3_wp*x(2, i))/real(row, wp))
         x(3, i) = 0.1_wp*sin(7.0_wp*x(1, i))*cos(5.0_wp*x(2, i)) + 0.1_wp*h*(x(3, i) - 0.5_wp)
      end do
   end subroutine place_points

   !> Time of one projection on an analytic sphere.
   real(wp) function analytic(x) result(nanoseconds)
      real(wp), intent(in) :: x(:, :)
      type(sphere_type) :: sphere
      type(foot_type) :: foot
      type(error_type), allocatable :: error
      real(wp) :: start, total
      integer :: i

      call new_sphere(sphere, [0.0_wp, 0.0_wp, -1.0_wp], 1.0_wp, error)
      total = 0.0_wp
      start = now()
      do i = 1, size(x, 2)
         call sphere%project(x(:, i), foot)
         total = total + foot%gap
      end do
      nanoseconds = (now() - start)*1.0e9_wp/real(size(x, 2), wp)
      ! The sum is used, so that no projection is left out.
      if (.not. abs(total) >= 0.0_wp) nanoseconds = -1.0_wp
   end function analytic
end program bench_search
