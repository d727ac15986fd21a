!> Checks of the installed program against closed forms: a pressed block on a rigid plane.
!>
!> Every method of contact must carry the pressure unchanged, and a block without friction shortens
!> as a bar: by p h (1 - nu^2)/E in plane strain, by p h/E in axial symmetry. Penalties add p/slope.
module lopin_selftest
   use lopin_build_model, only : new_model
   use lopin_clock, only : clock_type
   use lopin_deck, only : deck_type, read_deck_text
   use lopin_error, only : error_type, error_code, log_type, raise
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_recorder, only : recorder_holder_type
   use lopin_recorder_last, only : last_recorder_type
   use lopin_run_analysis, only : run_analysis
   use lopin_report, only : frame_type, summary_type
   use lopin_text, only : to_text
   implicit none
   private
   public :: selftest_case, ncase

   integer, parameter :: nx = 4, ny = 3
   real(wp), parameter :: young = 1000.0_wp, poisson = 0.3_wp, load = 10.0_wp, slope = 1.0e5_wp
   real(wp), parameter :: tolerance = 1.0e-9_wp   !! relative; the answers are exact up to rounding

   character(len=*), parameter :: methods(4) = [character(len=18) :: 'DIRECT', 'PENALTY', &
      & 'PERTURBED LAGRANGE', 'AUGMENTED LAGRANGE']
   character(len=*), parameter :: elements(2) = [character(len=4) :: 'CPE4', 'CAX4']
   integer, parameter :: ncase = size(methods)*size(elements)
   character(len=1), parameter :: nl = achar(10)

contains

   !> Run one case; `line` says what was found, `error` that it is wrong.
   subroutine selftest_case(number, line, error)
      integer, intent(in) :: number                      !! 1..ncase
      character(len=:), allocatable, intent(out) :: line
      type(error_type), allocatable, intent(out) :: error
      type(deck_type) :: deck
      type(model_type) :: model
      type(recorder_holder_type) :: recorder(1)
      type(clock_type) :: clock
      type(summary_type) :: summary
      type(log_type) :: log
      character(len=:), allocatable :: method, element

      method = trim(methods(1 + mod(number - 1, size(methods))))
      element = elements(1 + (number - 1)/size(methods))
      call read_deck_text(deck, deck_of(element, method), 'selftest', '', log, error)
      if (allocated(error)) return
      call new_model(model, deck, error)
      if (allocated(error)) return
      allocate (last_recorder_type :: recorder(1)%recorder)
      call run_analysis(model, recorder, clock, summary, log, error)
      if (allocated(error)) return
      select type (last => recorder(1)%recorder)
      type is (last_recorder_type)
         call check(last%frame, element//', '//method, shortening(element, method), line, error)
      end select
   end subroutine selftest_case

   subroutine check(frame, name, expected, line, error)
      type(frame_type), intent(in) :: frame
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: expected                   !! displacement of the top [length]
      character(len=:), allocatable, intent(out) :: line
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: pressure_error, displacement_error

      pressure_error = maxval(abs(frame%contact(1)%pressure - load))/load
      displacement_error = maxval(abs(frame%u(2, node_number(0, ny):node_number(nx, ny)) &
         & - expected))/abs(expected)
      line = name//': error of pressure '//to_text(pressure_error, 2)//', of displacement '// &
         & to_text(displacement_error, 2)
      if (pressure_error <= tolerance .and. displacement_error <= tolerance) return
      call raise(error, error_code%internal, 'E0902', 'selftest failed, '//line)
   end subroutine check

   pure real(wp) function shortening(element, method) result(u)
      character(len=*), intent(in) :: element, method

      u = -load*ny/young
      if (element == 'CPE4') u = u*(1.0_wp - poisson**2)
      if (method == 'PENALTY' .or. method == 'PERTURBED LAGRANGE') u = u - load/slope
   end function shortening

   pure integer function node_number(i, k)
      integer, intent(in) :: i, k   !! column and row, from 0
      node_number = 1 + i + k*(nx + 1)
   end function node_number

   !> A block of unit elements on a rigid plane; the left side slides, the right side is free.
   function deck_of(element, method) result(text)
      character(len=*), intent(in) :: element, method
      character(len=:), allocatable :: text
      integer :: i, k

      text = '*NODE'//nl
      do k = 0, ny
         do i = 0, nx
            text = text//to_text(node_number(i, k))//', '//to_text(i)//', '//to_text(k)//nl
         end do
      end do
      text = text//'999, 0., 0.'//nl//'*ELEMENT, ELSET=ALL, TYPE='//element//nl
      do k = 0, ny - 1
         do i = 0, nx - 1
            text = text//to_text(1 + i + k*nx)//', '//to_text(node_number(i, k))//', '// &
               & to_text(node_number(i + 1, k))//', '//to_text(node_number(i + 1, k + 1))//', '// &
               & to_text(node_number(i, k + 1))//nl
         end do
      end do
      text = text//'*ELSET, ELSET=LOW, GENERATE'//nl//'1, '//to_text(nx)//nl// &
         & '*ELSET, ELSET=HIGH, GENERATE'//nl//to_text(1 + (ny - 1)*nx)//', '//to_text(nx*ny)// &
         & nl// &
         & '*NSET, NSET=SIDE, GENERATE'//nl//'1, '//to_text(node_number(0, ny))//', '// &
         & to_text(nx + 1)//nl//'*MATERIAL, NAME=M'//nl//'*ELASTIC'//nl//to_text(young)//', '// &
         & to_text(poisson)//nl//'*SOLID SECTION, ELSET=ALL, MATERIAL=M'//nl// &
         & '*SURFACE, NAME=FOOT'//nl//'LOW, S1'//nl//'*SURFACE, NAME=GROUND, TYPE=SEGMENTS'//nl// &
         & 'START, -50., 0.'//nl//'LINE, 50., 0.'//nl// &
         & '*RIGID BODY, ANALYTICAL SURFACE=GROUND, REF NODE=999'//nl// &
         & '*SURFACE INTERACTION, NAME=I'//nl//'*SURFACE BEHAVIOR, '//method//nl
      if (method == 'PENALTY' .or. method == 'PERTURBED LAGRANGE') text = text//to_text(slope)//nl
      text = text//'*CONTACT PAIR, INTERACTION=I'//nl//'FOOT, GROUND'//nl//'*BOUNDARY'//nl// &
         & 'SIDE, 1'//nl//'999, 1, 2'//nl//'999, 6'//nl//'*STEP'//nl//'*STATIC'//nl//'1., 1.'// &
         & nl// &
         & '*DLOAD'//nl//'HIGH, P3, '//to_text(load)//nl//'*END STEP'//nl
   end function deck_of
end module lopin_selftest
