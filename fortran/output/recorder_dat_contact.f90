!> The tables of *CONTACT PRINT, in CalculiX's layout.
!>
!> CDIS or COPEN: gap and tangential motion; CSTR or CPRESS: pressure and shear; CF, CFN, CFS: the
!> resultant of a pair with its moment, area and centre (closed points); CNUM: closed points.
module lopin_recorder_dat_contact
   use lopin_kinds, only : wp
   use lopin_vectors, only : cross
   use lopin_model, only : model_type, output_type
   use lopin_pair_activity, only : asks_pair
   use lopin_report, only : frame_type, contact_field_type
   use lopin_text_buffer, only : text_buffer_type
   use lopin_vtu_writer, only : three_components
   use lopin_recorder_table, only : has_variable
   implicit none
   private
   public :: put_contact, contact_components

   integer, parameter :: both = 1, normal_part = 2, shear_part = 3

   !> What a pair presses, all together.
   type :: resultant_type
      real(wp) :: force(3) = 0.0_wp                  !! [force]
      real(wp) :: moment(3) = 0.0_wp                 !! about the origin [force length]
      real(wp) :: area = 0.0_wp                      !! [area]
      real(wp) :: centre(3) = 0.0_wp                 !! [length]
      real(wp) :: normal(3) = 0.0_wp                 !! mean of the slave, unit
   end type resultant_type

contains

   subroutine put_contact(text, model, output, frame)
      type(text_buffer_type), intent(inout) :: text
      type(model_type), intent(in) :: model
      type(output_type), intent(in) :: output
      type(frame_type), intent(in) :: frame

      if (has_variable(output%variable, ['CDIS    ', 'COPEN   ', 'CDISP   '])) then
         call put_points(text, model, output, frame, .false.)
      end if
      if (has_variable(output%variable, ['CSTR    ', 'CPRESS  ', 'CSTRESS '])) then
         call put_points(text, model, output, frame, .true.)
      end if
      if (has_variable(output%variable, ['CNUM    '])) call put_count(text, frame)
      if (has_variable(output%variable, ['CF      ', 'CFORCE  '])) call put_pairs(text, model, &
         & output, &
         & frame, both)
      if (has_variable(output%variable, ['CFN     '])) call put_pairs(text, model, output, &
         & frame, normal_part)
      if (has_variable(output%variable, ['CFS     '])) call put_pairs(text, model, output, &
         & frame, shear_part)
   end subroutine put_contact

   !> Gap, pressure and their tangential companions of a slave point: CalculiX's six numbers.
   !> Shear has the sign of the slip that it resists, as there: what the slave does to its master.
   pure function contact_components(field, i) result(six)
      type(contact_field_type), intent(in) :: field
      integer, intent(in) :: i
      real(wp) :: six(6)
      real(wp) :: n(3), t(3, 2), shear(3)
      integer :: d

      d = size(field%normal, 1)
      n = 0.0_wp
      n(:d) = field%normal(:, i)
      call tangents(n, d, t)
      shear = 0.0_wp
      if (field%weight(i) > 0.0_wp) then
         shear(:d) = -field%shear(:, i)/field%weight(i)
      end if
      six(1) = field%gap(i)
      six(2:3) = matmul(field%u_t(:, i), t(:d, :))
      six(4) = field%pressure(i)
      six(5:6) = matmul(shear, t)
   end function contact_components

   !> In the plane: along the surface and across; in space: the x axis laid on the surface (or z),
   !> and across.
   pure subroutine tangents(n, d, t)
      real(wp), intent(in) :: n(3)
      integer, intent(in) :: d
      real(wp), intent(out) :: t(3, 2)
      real(wp), parameter :: nearly_parallel = 0.9999_wp
      real(wp) :: axis(3), length

      axis = [1.0_wp, 0.0_wp, 0.0_wp]
      if (abs(n(1)) > nearly_parallel) axis = [0.0_wp, 0.0_wp, 1.0_wp]
      if (d == 2) axis = [-n(2), n(1), 0.0_wp]
      t(:, 1) = axis - dot_product(axis, n)*n
      length = norm2(t(:, 1))
      if (length > 0.0_wp) t(:, 1) = t(:, 1)/length
      t(:, 2) = cross(n, t(:, 1))
   end subroutine tangents

   subroutine put_points(text, model, output, frame, stress)
      type(text_buffer_type), intent(inout) :: text
      type(model_type), intent(in) :: model
      type(output_type), intent(in) :: output
      type(frame_type), intent(in) :: frame
      logical, intent(in) :: stress        !! pressure and shear; else gap and slip
      character(len=14) :: time
      real(wp) :: six(6)
      integer :: p, i, k

      write (time, '(e14.7)') frame%total_time
      call text%put_line()
      if (stress) then
         call text%put_line(' contact stress (slave node,press,tang1,tang2) for all contact '// &
            & 'elements and time'//time)
      else
         call text%put_line(' relative contact displacement (slave node,normal,tang1,tang2) '// &
            & 'for all contact elements and time'//time)
      end if
      call text%put_line()
      do p = 1, size(frame%contact)
         if (.not. asks_pair(model, output, p)) cycle
         associate (field => frame%contact(p))
            do i = 1, size(field%node)
               if (field%status(i) < merge(1, 0, stress)) cycle
               six = contact_components(field, i)
               call text%put_integer(model%mesh%node_label(field%node(i)), 10)
               do k = merge(4, 1, stress), merge(6, 3, stress)
                  call text%put(' ')
                  call text%put_exponential(six(k), 6)
               end do
               call text%put_line()
            end do
         end associate
      end do
   end subroutine put_points

   subroutine put_count(text, frame)
      type(text_buffer_type), intent(inout) :: text
      type(frame_type), intent(in) :: frame
      character(len=14) :: time
      integer :: p, n

      n = 0
      do p = 1, size(frame%contact)
         n = n + count(frame%contact(p)%status > 0)
      end do
      write (time, '(e14.7)') frame%total_time
      call text%put_line()
      call text%put_line(' total number of contact elements for time '//time)
      call text%put_line()
      call text%put_integer(n, 17)
      call text%put_line()
   end subroutine put_count

   subroutine put_pairs(text, model, output, frame, part)
      type(text_buffer_type), intent(inout) :: text
      type(model_type), intent(in) :: model
      type(output_type), intent(in) :: output
      type(frame_type), intent(in) :: frame
      integer, intent(in) :: part
      integer :: p

      do p = 1, size(frame%contact)
         if (asks_pair(model, output, p)) call put_resultant(text, model, frame, p, part)
      end do
   end subroutine put_pairs

   !> Force of the master on the slave. The mean normal is that of the slave, as CalculiX prints it.
   subroutine put_resultant(text, model, frame, p, part)
      type(text_buffer_type), intent(inout) :: text
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      integer, intent(in) :: p, part
      type(resultant_type) :: total
      real(wp) :: at_normal
      character(len=14) :: time
      character(len=:), allocatable :: master

      call integrate(model, frame, frame%contact(p), part, total)
      master = ''
      if (model%pair(p)%master > 0) master = model%surface(model%pair(p)%master)%name
      write (time, '(e14.7)') frame%total_time
      call text%put_line()
      call text%put_line()
      call text%put_line(' statistics for slave set '//model%surface(model%pair(p)%slave)%name// &
         & ', master set '//master//' and time '//time)
      call text%put_line()
      call text%put_line('   total surface force (fx,fy,fz) and moment about the origin (mx,my,mz)')
      call put_row([total%force, total%moment])
      call text%put_line()
      call text%put_line('   center of gravity and mean normal')
      call put_row([total%centre, total%normal])
      call text%put_line()
      call text%put_line('   moment about the center of gravity(mx,my,mz)')
      call put_row(total%moment - cross(total%centre, total%force))
      call text%put_line()
      call text%put_line('   area,  normal force (+ = tension) and shear force (size)')
      at_normal = dot_product(total%force, total%normal)
      call put_row([total%area, at_normal, norm2(total%force - at_normal*total%normal)])
   contains
      subroutine put_row(values)
         real(wp), intent(in) :: values(:)
         integer :: k

         call text%put_line()
         call text%put('  ')
         do k = 1, size(values)
            call text%put(' ')
            call text%put_exponential(values(k), 6)
         end do
         call text%put_line()
      end subroutine put_row
   end subroutine put_resultant

   subroutine integrate(model, frame, field, part, total)
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      type(contact_field_type), intent(in) :: field
      integer, intent(in) :: part
      type(resultant_type), intent(out) :: total
      real(wp) :: x(3), f(3), n(3), along(3)
      integer :: i

      do i = 1, size(field%node)
         if (field%status(i) <= 0) cycle
         x = reshape(three_components(model%mesh%x(:, field%node(i):field%node(i))), [3]) &
            & + frame%u(:3, field%node(i))
         f = reshape(three_components(field%force(:, i:i)), [3])
         n = reshape(three_components(field%normal(:, i:i)), [3])
         along = reshape(three_components(field%shear(:, i:i)), [3])
         if (part == normal_part) f = f - along
         if (part == shear_part) f = along
         total%force = total%force + f
         total%moment = total%moment + cross(x, f)
         ! Shears act on the point's own node, or weigh out to it.
         if (part /= shear_part) total%moment = total%moment + field%couple(:, i)
         total%area = total%area + field%weight(i)
         total%centre = total%centre + field%weight(i)*x
         total%normal = total%normal - field%weight(i)*n
      end do
      if (total%area > 0.0_wp) total%centre = total%centre/total%area
      if (norm2(total%normal) > 0.0_wp) total%normal = total%normal/norm2(total%normal)
   end subroutine integrate
end module lopin_recorder_dat_contact
