program test_uniform_pressure
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_id
   use lopin_error, only : error_type
   use lopin_facets, only : facets_type
   use lopin_surface, only : surface_type, new_surface, update_surface
   use lopin_uniform_pressure, only : share_pressure
   use check, only : test, close_to, is_true, finish
   implicit none
   !> Shares of a facet end by whole samples: an eighth of a slave facet, its square in a moment.
   real(wp), parameter :: sampled = 0.01_wp
   type(surface_type) :: slave, master
   real(wp), allocatable :: x(:, :), force(:, :), area(:)
   logical, allocatable :: met(:)

   call test('on matching facets both sides get the areas of their nodes')
   call lines([0.0_wp, 1.0_wp, 2.0_wp], [0.0_wp, 1.0_wp, 2.0_wp])
   call share([1, 2], .false.)
   call close_to('slave', force(2, 4:), [0.5_wp, 1.0_wp, 0.5_wp], 1.0e-13_wp)
   call close_to('master', force(2, :3), -[0.5_wp, 1.0_wp, 0.5_wp], 1.0e-13_wp)
   call close_to('area', area, [0.5_wp, 1.0_wp, 0.5_wp], 1.0e-13_wp)
   call is_true('all are met', all(met))

   call test('a master facet covered by half gets what its functions make of that half')
   call lines([0.0_wp, 2.0_wp, 4.0_wp], [0.0_wp, 1.0_wp, 2.0_wp, 3.0_wp])
   call share([1, 2, 3], .false.)
   call close_to('slave', force(2, 4:), [0.5_wp, 1.0_wp, 1.0_wp, 0.5_wp], 1.0e-13_wp)
   call close_to('master', force(2, :3), -[1.0_wp, 1.75_wp, 0.25_wp], sampled)

   call test('what the master does not cover carries nothing')
   call lines([0.0_wp, 1.0_wp], [0.0_wp, 1.0_wp, 2.0_wp])
   call share([1, 2], .false.)
   call close_to('slave', force(2, 3:), [0.5_wp, 0.5_wp, 0.0_wp], sampled)
   call close_to('area', area, [0.5_wp, 0.5_wp, 0.0_wp], 1.0e-13_wp)

   call test('forces and moments of both sides balance')
   call lines([-1.0_wp, 0.3_wp, 1.1_wp, 2.5_wp, 4.0_wp], [0.0_wp, 0.7_wp, 2.0_wp, 3.0_wp])
   call share([1, 2, 3], .false.)
   call close_to('force', sum(force, 2), [0.0_wp, 0.0_wp], 1.0e-13_wp)
   call close_to('moment', sum(force(2, :)*x(1, :)), 0.0_wp, 1.0e-13_wp)

   call test('rings weigh by their radius: that on the axis a third')
   call lines([0.0_wp, 1.0_wp, 2.0_wp], [0.0_wp, 1.0_wp, 2.0_wp])
   call share([1, 2], .true.)
   call close_to('slave', force(2, 4:), [1.0_wp, 6.0_wp, 5.0_wp]/6.0_wp, sampled)
   call close_to('whole', sum(area), 2.0_wp, 1.0e-13_wp)
   call finish()

contains

   !> A master with these nodes at height 0, its outside up, and a slave above with those.
   subroutine lines(below, above)
      real(wp), intent(in) :: below(:), above(:)
      type(facets_type) :: facets
      type(error_type), allocatable :: error
      integer :: i, n

      n = size(below)
      x = reshape([(below(i), 0.0_wp, i=1, n), (above(i), 0.0_wp, i=1, size(above))], &
         & [2, n + size(above)])
      call line(facets, [(i, i=n, 1, -1)])
      call new_surface(master, 2, facets)
      call update_surface(master, x, error)
      call line(facets, [(n + i, i=1, size(above))])
      call new_surface(slave, 2, facets)
      call update_surface(slave, x, error)
      call is_true('no error', .not. allocated(error))
   end subroutine lines

   !> The outside lies to the right of the way.
   subroutine line(facets, node)
      type(facets_type), intent(out) :: facets
      integer, intent(in) :: node(:)
      integer :: i, n

      n = size(node) - 1
      facets%n = n
      facets%element = [(i, i=1, n)]
      facets%face = spread(1, 1, n)
      facets%cell = spread(cell_id%line2, 1, n)
      facets%nnode = spread(2, 1, n)
      allocate (facets%node(8, n), source=0)
      facets%node(1, :) = node(:n)
      facets%node(2, :) = node(2:)
   end subroutine line

   subroutine share(facet, axisymmetric)
      integer, intent(in) :: facet(:)
      logical, intent(in) :: axisymmetric

      force = 0.0_wp*x
      if (allocated(area)) deallocate (area)
      if (allocated(met)) deallocate (met)
      allocate (area(slave%nnode), met(master%facets%n))
      call share_pressure(slave, facet, master, axisymmetric, force, area, met)
   end subroutine share
end program test_uniform_pressure
