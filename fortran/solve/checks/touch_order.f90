!> First touch with shear: friction reads the order in which points touch.
!>
!> Slip counts from where each point touched (lopin_touch_onset, lopin_friction_touch), but the
!> pressures of one increment stand for all of its slips. Where the contact of a pair begins in an
!> increment, its points touch one after another and carry a net shear, the increment ends at the
!> first touch, and the rest is done in parts.
module lopin_touch_order
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_model, only : model_type
   use lopin_friction, only : has_friction
   use lopin_repeated_messages, only : warn_once
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: check_touch_order, order_id, parts_of_touch

   character(len=*), parameter :: order_id = 'E0552'
   integer, parameter :: parts_of_touch = 5
   !> Forces of late points, and net shear, beside the force of contact: less does not matter.
   real(wp), parameter :: late_share = 0.01_wp, net_share = 0.05_wp

contains

   !> `scene%first_touch` is then the share of the increment before it.
   subroutine check_touch_order(scene, model, direct, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      logical, intent(in) :: direct            !! increments are not cut
      type(error_type), allocatable, intent(out) :: error
      integer :: pair

      if (.not. (scene%may_part .or. direct)) return
      do pair = 1, size(model%pair)
         if (.not. has_friction(model%interaction(model%pair(pair)%interaction)%friction)) cycle
         if (scene%newton%in_use) then
            if (.not. late_on_shape(scene, pair)) cycle
         else
            if (.not. late_on_rows(scene, pair)) cycle
         end if
         associate (text => 'points of '//model%surface(model%pair(pair)%slave)%name// &
            & ' first touch '//model%surface(model%pair(pair)%master)%name//' one after '// &
            & 'another in one increment, which shears them too')
            if (direct) then
               call warn_once(scene%log, 'W0551', text, model%step(scene%step)%at, &
                  & help='smaller increments on *STATIC')
            else
               call raise(error, error_code%not_converged, order_id, text, &
                  & model%step(scene%step)%at, help='smaller increments on *STATIC')
               return
            end if
         end associate
      end do
   end subroutine check_touch_order

   logical function late_on_shape(scene, pair) result(late)
      type(scene_type), intent(inout) :: scene
      integer, intent(in) :: pair
      real(wp) :: shear(3, scene%newton%contact%n), press(scene%newton%contact%n)
      logical :: closed(scene%newton%contact%n)
      integer :: i

      late = .false.
      associate (c => scene%newton%contact)
         do i = 1, c%n
            if (c%pair(i) == pair .and. any(abs( &
               & scene%accepted%contact%traction(:, i)) > 0.0_wp)) return
            closed(i) = c%pair(i) == pair .and. c%status(i) > 0
            press(i) = c%weight(i)*c%pressure(i)
            shear(:, i) = c%weight(i)*c%traction(:, i) - press(i)*c%normal(:, i)
         end do
         late = is_late(scene, closed, c%touch, press, shear)
      end associate
   end function late_on_shape

   logical function late_on_rows(scene, pair) result(late)
      type(scene_type), intent(inout) :: scene
      integer, intent(in) :: pair
      real(wp) :: press(scene%points%n)
      logical :: closed(scene%points%n)
      integer :: row

      late = .false.
      associate (of => scene%points%first(pair), to => scene%points%first(pair + 1) - 1, &
         & before => scene%accepted%friction, after => scene%trial%friction, &
         & touch => scene%friction%touch)
         if (.not. allocated(scene%friction%touch)) return
         if (any(before%status(of:to) > 0)) return
         press = 0.0_wp
         do row = scene%rows%group_first(pair), scene%rows%group_first(pair + 1) - 1
            press(scene%rows%point(row)) = scene%answer%force(row)
         end do
         closed = .false.
         closed(of:to) = after%status(of:to) > 0
         late = is_late(scene, closed, touch, press, after%traction)
      end associate
   end function late_on_rows

   !> Whether enough of the force is at points that touched late.
   logical function is_late(scene, closed, touch, press, shear)
      type(scene_type), intent(inout) :: scene
      logical, intent(in) :: closed(:)
      real(wp), intent(in) :: touch(:)         !! share of the increment before they touched
      real(wp), intent(in) :: press(:), shear(:, :)   !! (3, n) [force]
      real(wp) :: late, net(3), first
      integer :: i

      is_late = .false.
      if (.not. any(closed)) return
      first = minval(touch, mask=closed)
      ! What touches where the increment ends, but for less than an increment, touches at once.
      if (.not. 1.0_wp - first > parts_of_touch*scene%least_part) return
      late = 0.0_wp
      net = 0.0_wp
      do i = 1, size(closed)
         if (.not. closed(i)) cycle
         late = late + abs(press(i))*(touch(i) - first)/(1.0_wp - first)
         net = net + shear(:, i)
      end do
      associate (all => sum(abs(press), mask=closed))
         is_late = late > late_share*all .and. norm2(net) > net_share*all
      end associate
      if (is_late) scene%first_touch = first
   end function is_late
end module lopin_touch_order
