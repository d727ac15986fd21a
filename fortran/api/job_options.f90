!> Options of a job as callers of the library give them: a line each, name=value.
module lopin_job_options
   use lopin_error, only : error_type, error_code, raise
   use lopin_job, only : job_type
   use lopin_text, only : parse_integer, quoted
   implicit none
   private
   public :: read_options

   character(len=1), parameter :: nl = achar(10)

contains

   !> What is not known is an error.
   subroutine read_options(job, options, error)
      type(job_type), intent(inout) :: job
      character(len=*), intent(in) :: options
      type(error_type), allocatable, intent(out) :: error
      integer :: first, length, equals
      logical :: ok

      job%solver = ''
      first = 1
      do while (first <= len(options))
         length = index(options(first:)//nl, nl) - 1
         associate (line => options(first:first + length - 1))
            equals = index(line//'=', '=')
            ok = .true.
            select case (line(:equals - 1))
            case ('solver')
               job%solver = line(equals + 1:)
            case ('threads')
               call parse_integer(line(equals + 1:), job%threads, ok)
               ok = ok .and. job%threads > 0
            case ('deterministic')
               job%deterministic = .true.
            case ('strict')
               job%strict = .true.
            case ('resume')
               job%resume = .true.
            case ('overwrite')
               job%overwrite = .true.
            case ('interruptible')
               job%interruptible = .true.
            case ('stepwise')
               job%stepwise = .true.
            case default
               ok = len(line) == 0
            end select
            if (.not. ok) then
               call raise(error, error_code%usage, 'E0801', 'no such option: '//quoted(line), &
                  & help='options are solver=, threads= (from 1), deterministic, strict, '// &
                  & 'resume and overwrite')
               return
            end if
         end associate
         first = first + length + 1
      end do
   end subroutine read_options
end module lopin_job_options
