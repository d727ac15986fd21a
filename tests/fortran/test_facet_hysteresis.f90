!> Points in the joint of two facets: what is kept, for how long, and how near it stays.
program test_facet_hysteresis
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_facets, only : facets_type
   use lopin_projection, only : place
   use lopin_surface, only : surface_type, new_surface, update_surface
   use lopin_feature, only : projection_type, limits_type
   use lopin_search, only : tree_type, build_tree, find_projection
   use lopin_facet_hysteresis, only : facet_hysteresis_type, new_facet_hysteresis, &
      & start_facet_hysteresis, record_facet, kept_beyond, keep_facet, most_past, most_apart, &
      & most_returns
   use patch_scenes, only : patch_names, patch_dimension, new_patch
   use check, only : test, is_true, close_to, finish
   implicit none

   integer :: i

   call random_init(.true., .false.)
   call who_returns_keeps()
   call who_is_too_far_is_refused()
   call what_is_rejected_leaves_no_trace()
   do i = 1, size(patch_names)
      call kept_is_near(trim(patch_names(i)))
   end do
   call finish()

contains

   pure type(projection_type) function at_facet(facet) result(found)
      integer, intent(in) :: facet
      found%facet = facet
      found%place = place%inside
   end function at_facet

   subroutine who_returns_keeps()
      type(facet_hysteresis_type) :: owner

      integer :: turn

      call test('a point that returns often keeps the facet')
      call new_facet_hysteresis(owner, 2)
      call start_facet_hysteresis(owner, [4, 0])
      do turn = 1, most_returns + 1
         call record_facet(owner, 1, at_facet(7 + mod(turn, 2)), .false.)
         call record_facet(owner, 1, at_facet(7 + mod(turn, 2)), .false.)
      end do
      call is_true('a few times are chance', owner%held(1) == 0)
      call record_facet(owner, 1, at_facet(7 + mod(most_returns, 2)), .false.)
      call is_true('more are not', owner%held(1) == 7 + mod(most_returns, 2))
      call record_facet(owner, 1, at_facet(owner%held(1)), .true.)
      call is_true('it stays', owner%held(1) == 7 + mod(most_returns, 2))
      call test('so does one beside the perimeter, on the facet continued there')
      call start_facet_hysteresis(owner, [4, 0])
      do turn = 1, most_returns + 2
         call record_facet(owner, 1, projection_type(facet=7 + mod(turn, 2), &
            & place=place%extended), .false.)
      end do
      call is_true('kept', owner%held(1) == 7 + mod(most_returns, 2))
      call test('a point that goes on keeps nothing')
      call record_facet(owner, 2, at_facet(1), .false.)
      call record_facet(owner, 2, at_facet(2), .false.)
      call record_facet(owner, 2, at_facet(3), .false.)
      call record_facet(owner, 2, at_facet(4), .false.)
      call is_true('the nearest', owner%held(2) == 0)
   end subroutine who_returns_keeps

   subroutine who_is_too_far_is_refused()
      type(facet_hysteresis_type) :: owner
      integer :: turn

      call test('a facet that no longer carries the point is not kept again')
      call new_facet_hysteresis(owner, 1)
      call start_facet_hysteresis(owner, [4])
      do turn = 1, most_returns + 2
         call record_facet(owner, 1, at_facet(7 + mod(turn, 2)), .false.)
      end do
      call is_true('kept', owner%held(1) > 0)
      call record_facet(owner, 1, at_facet(9), .false.)
      call is_true('given up', owner%held(1) == 0)
      do turn = 1, 3*most_returns
         call record_facet(owner, 1, at_facet(7 + mod(turn, 2)), owner%held(1) == 7 + mod(turn, 2))
         call is_true('not again', owner%held(1) /= owner%refused(1))
      end do
   end subroutine who_is_too_far_is_refused

   subroutine what_is_rejected_leaves_no_trace()
      type(facet_hysteresis_type) :: owner
      integer :: turn

      call test('owners of a rejected increment')
      call new_facet_hysteresis(owner, 1)
      call start_facet_hysteresis(owner, [4])
      call is_true('an increment starts with what was accepted', owner%held(1) == 4)
      do turn = 1, most_returns + 2
         call record_facet(owner, 1, at_facet(7 + mod(turn, 2)), .false.)
      end do
      call is_true('the trial has another', owner%held(1) > 4)
      call start_facet_hysteresis(owner, [4])
      call is_true('back', owner%held(1) == 4)
      call is_true('without memory', owner%returns(1) + owner%refused(1) + sum(owner%last) &
         & + sum(owner%before) == 0)
      call is_true('past the end it is kept', kept_beyond(owner, 1, .true.) == 4)
      call is_true('within, the nearest facet does', kept_beyond(owner, 1, .false.) == 0)
   end subroutine what_is_rejected_leaves_no_trace

   !> Every facet of valleys and domes, from random places around them.
   subroutine kept_is_near(name)
      character(len=*), intent(in) :: name
      type(facets_type) :: facets
      type(surface_type) :: surface
      type(tree_type) :: tree
      type(error_type), allocatable :: error
      type(projection_type) :: nearest, found
      type(limits_type) :: limits
      real(wp), allocatable :: x(:, :), y(:), side(:)
      real(wp) :: apart, past_by
      integer :: d, k, facet, nkept, npast, wrong
      logical :: kept, past

      call test('a kept facet is as near as the nearest: '//name)
      call new_patch(name, x, facets)
      d = patch_dimension(name)
      ! Flat roofs, upside down: shallow valleys.
      x(d, :) = -0.2_wp*x(d, :)
      call new_surface(surface, d, facets)
      call update_surface(surface, x, error)
      call is_true('there is a surface', .not. allocated(error))
      call build_tree(tree, surface%low, surface%high)
      allocate (y(d), side(d))
      nkept = 0
      npast = 0
      wrong = 0
      apart = 0.0_wp
      past_by = 0.0_wp
      do k = 1, 2000
         call random_number(y)
         y = 2.0_wp*y - 1.0_wp
         y(d) = 0.2_wp*y(d)
         side = 0.0_wp
         if (mod(k, 2) == 0) side(d) = -1.0_wp
         call find_projection(surface, tree, y, side, limits, nearest)
         do facet = 1, facets%n
            found = nearest
            call keep_facet(surface, facet, y, side, limits, found, kept, past)
            if (.not. past .and. (found%facet /= nearest%facet .or. &
               & abs(found%gap - nearest%gap) > 0.0_wp)) wrong = wrong + 1
            if (kept) nkept = nkept + 1
            if (.not. past) cycle
            npast = npast + 1
            if (found%facet /= facet) wrong = wrong + 1
            apart = max(apart, abs(found%gap - nearest%gap)/surface%size(facet))
            past_by = max(past_by, maxval(abs(found%xi)) - 1.0_wp)
         end do
      end do
      call is_true('some are kept', nkept > npast .and. npast > 0)
      call is_true('else the nearest stays', wrong == 0)
      call is_true('not farther', apart <= most_apart)
      call is_true('not farther past the end', past_by <= 2.0_wp*most_past*(1.0_wp + 1.0e-12_wp))
   end subroutine kept_is_near
end program test_facet_hysteresis
