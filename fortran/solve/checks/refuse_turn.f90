!> Limit of the rotation of a tool in one increment under points that slide on it: the slip is taken
!> along the chord.
!>
!> On the present shape the slip of an increment is the straight way in the frame of the tool from
!> the place where a point was to where it is. A tool that turns by t below a point that stands
!> still draws an arc there: the shear is then off by t/2 in direction, the torque by 1 - cos(t/2),
!> and after a full turn nothing seems to have slid. Points that go with the tool draw none.
module lopin_refuse_turn
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_friction, only : has_friction
   use lopin_rigid_motion, only : rotation_matrix
   use lopin_repeated_messages, only : warn_once
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: refuse_turn, turn_id, most_turn

   character(len=*), parameter :: turn_id = 'E0553'
   !> A sixtieth of a turn: shears off by 5 %, torques by .14 % [rad].
   real(wp), parameter :: most_turn = acos(-1.0_wp)/30.0_wp
   real(wp), parameter :: degree = 180.0_wp/acos(-1.0_wp)
   !> Slips that matter, beside a facet.
   real(wp), parameter :: least_slip = 0.01_wp

contains

   !> `scene%turned` is then the largest angle between tool and sliding point in the increment.
   subroutine refuse_turn(scene, model, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: text
      real(wp) :: turn(3), angle
      integer :: i, worst

      scene%turned = 0.0_wp
      if (.not. scene%newton%in_use) return
      worst = 0
      associate (c => scene%newton%contact)
         do i = 1, c%n
            if (c%status(i) <= 0 .or. .not. c%anchor(i)%set) cycle
            if (.not. has_friction(c%friction(c%pair(i)))) cycle
            if (c%masters%of(c%pair(i))%body == 0) cycle
            turn = turn_of(scene, model, c%masters%of(c%pair(i))%body)
            if (norm2(turn) <= most_turn) cycle
            angle = angle_of(scene, model, i, turn)
            if (.not. angle > scene%turned) cycle
            scene%turned = angle
            worst = i
         end do
         if (.not. scene%turned > most_turn) return
         associate (step => model%step(scene%step), pair => model%pair(c%pair(worst)))
            text = model%surface(pair%master)%name//' turns by '//to_text(degree*scene%turned, 3) &
               & //' degrees in an increment below '//model%surface(pair%slave)%name//', which '// &
               & 'slides on it: friction takes the chord of the way'
            if (scene%may_cut) then
               call raise(error, error_code%not_converged, turn_id, text, step%at, &
                  & help='smaller increments on *STATIC')
            else
               call warn_once(scene%log, 'W0553', text//': shears are off by up to '// &
                  & to_text(0.5_wp*degree*scene%turned, 3)//' degrees, and work and torque '// &
                  & 'with them', step%at, help='increments of 6 degrees at most on *STATIC')
            end if
         end associate
      end associate
   end subroutine refuse_turn

   !> Rotation of a tool in the increment [rad].
   pure function turn_of(scene, model, body) result(turn)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: body
      real(wp) :: turn(3)
      integer :: k

      turn = 0.0_wp
      do k = 1, 3
         associate (dof => scene%dofs%id(3 + k, model%rigid_body(body)%reference))
            if (dof > 0) turn(k) = scene%trial%motion%u(dof) - scene%accepted%motion%u(dof)
         end associate
      end do
   end function turn_of

   !> Angle about the axis of the tool by which it went round more than a point did [rad]; 0 where
   !> that is no slip to speak of. A point goes round by half a turn at most.
   pure real(wp) function angle_of(scene, model, i, turn) result(angle)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: i
      real(wp), intent(in) :: turn(3)          !! of the tool in the increment [rad]
      real(wp) :: axis(3), from(3), to(3), cross(3), start(3, 3)

      axis = turn/norm2(turn)
      from = 0.0_wp
      to = 0.0_wp
      associate (c => scene%newton%contact, d => model%mesh%ndim)
         associate (motion => c%masters%of(c%pair(i))%motion, &
            & rotation => c%masters%of(c%pair(i))%rotation)
            from(:d) = c%anchor(i)%y(:d) - motion%reference(:d)
            start = rotation_matrix(rotation - turn)
            to(:d) = c%masters%x(:d, c%node(i)) - motion%reference(:d) - motion%displacement(:d)
         end associate
         from = matmul(start, from)
         from = from - dot_product(from, axis)*axis
         to = to - dot_product(to, axis)*axis
         cross = [from(2)*to(3) - from(3)*to(2), from(3)*to(1) - from(1)*to(3), &
            & from(1)*to(2) - from(2)*to(1)]
         angle = abs(norm2(turn) - atan2(dot_product(cross, axis), dot_product(from, to)))
         if (angle*norm2(from) < least_slip*c%size(i)) angle = 0.0_wp
      end associate
   end function angle_of
end module lopin_refuse_turn
